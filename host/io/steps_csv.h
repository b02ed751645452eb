#pragma once
// steps.csv: one line per step with the quantities that the model of dynamics reports.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynamics/dynamics_card.h"
#include "host/world.h"

namespace scree {

/// Appends lines to steps.csv, held back for at most a second or 100 lines. A line is written in
/// one piece. The system finishes such a piece even for a process being killed, unless the line
/// lies across two memory pages and the kill hits between them: then readers find, and leave out, a
/// torn last line.
class StepsCsv {
 public:
  /// Starts a new file, or continues one after the given step.
  /// @param columns      of the model. A file that goes on keeps its own, which may be fewer: those of
  ///                     an earlier version
  /// @param resume_step  number of steps done by the checkpoint: later lines, and a torn last one,
  ///                     are cut off. Not set, or no file there: a new file
  /// @throws InputError when the file to continue has columns that are not known, or its steps do not
  ///         rise,
  /// @throws RunError when the file cannot be written
  explicit StepsCsv(std::filesystem::path path, std::span<const ReportColumn> columns,
                    std::optional<std::int64_t> resume_step = {});
  ~StepsCsv();  ///< flushes; errors are lost, call flush() to see them
  StepsCsv(const StepsCsv&) = delete;
  StepsCsv& operator=(const StepsCsv&) = delete;

  /// Steps before the checkpoint that the continued file has no lines of: it was cut or removed.
  std::int64_t missing_steps() const { return missing_steps_; }

  /// @throws RunError when a flush is due and the file cannot be written
  void append(const StepReport& report);

  /// Writes the lines held back. Call it before a checkpoint is written, so that no step of the
  /// checkpoint can be missing here.
  /// @throws RunError when the file cannot be written, and then ends after a whole line,
  ///         or when it was removed
  void flush();

 private:
  void write_line(std::string_view line);

  std::filesystem::path path_;
  std::vector<ReportColumn> columns_;
  int descriptor_ = -1;
  std::int64_t missing_steps_ = 0;
  std::string pending_;
  int pending_lines_ = 0;
  std::chrono::steady_clock::time_point last_flush_;
};

/// Changes nothing. @throws InputError as StepsCsv does of a file to continue
void check_steps_csv(const std::filesystem::path& path, std::span<const ReportColumn> columns,
                     std::int64_t resume_step);

/// Reads the lines of a steps.csv back; a torn last line is left out. Quantities that it has no column
/// of are those of an empty report.
/// @throws InputError naming the file, the line and what was expected
std::vector<StepReport> read_steps_csv(const std::filesystem::path& path,
                                       std::span<const ReportColumn> columns);

}  // namespace scree
