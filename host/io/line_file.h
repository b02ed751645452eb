#pragma once
// A text file that grows by whole lines, for the tables of a run.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace scree {

/// Appends lines, held back for at most a second or 100 lines. A line is written in one piece. The system finishes such a
/// piece even for a process being killed, unless the line lies across two memory pages and the kill hits between them: then
/// readers find, and leave out, a torn last line.
class LineFile {
 public:
  /// @param kept_bytes  of a file that goes on: what follows is cut off
  /// @param header      first line of a file that does not go on, with its end
  /// @throws RunError when the file cannot be written
  LineFile(std::filesystem::path path, std::uint64_t kept_bytes, std::string header);
  ~LineFile();  ///< flushes; errors are lost, call flush() to see them
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// Where the next line goes, with its end; then say so with line_done().
  std::string& pending() { return pending_; }
  /// @throws RunError when a flush is due and the file cannot be written
  void line_done();

  /// Writes the lines held back. Call it before a checkpoint is written, so that no line of the
  /// checkpoint can be missing here.
  /// @throws RunError when the file cannot be written, and then ends after a whole line,
  ///         or when it was removed
  void flush();

 private:
  void write_line(std::string_view line);

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::string pending_;
  int pending_lines_ = 0;
  std::chrono::steady_clock::time_point last_flush_;
};

}  // namespace scree
