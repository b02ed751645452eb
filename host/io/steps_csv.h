#pragma once
// steps.csv: one line per step with the quantities that the model of dynamics reports.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "dynamics/dynamics_card.h"
#include "host/io/line_file.h"
#include "host/world.h"

namespace scree {

/// Writes steps.csv, see LineFile.
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

  /// Steps before the checkpoint that the continued file has no lines of: it was cut or removed.
  std::int64_t missing_steps() const { return missing_steps_; }

  /// @throws RunError when a flush is due and the file cannot be written
  void append(const StepReport& report);

  /// As LineFile::flush().
  void flush() { file_->flush(); }

 private:
  std::vector<ReportColumn> columns_;
  std::int64_t missing_steps_ = 0;
  std::optional<LineFile> file_;
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
