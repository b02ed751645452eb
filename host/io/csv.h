#pragma once
// Tables in text files: a header line with column names, then one row a line.

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace scree {

/// Reads row by row. Columns are separated by commas; spaces around values, empty lines and lines
/// that start with # are skipped.
class CsvReader {
 public:
  /// Reads the header. @param known  column names that are allowed
  /// @throws InputError naming the file: missing, unreadable, empty, or an unknown
  ///         or repeated column
  CsvReader(std::filesystem::path file, const std::vector<std::string>& known);

  const std::vector<std::string>& columns() const { return columns_; }
  /// Position of a column, or -1.
  int find(const std::string& column) const;
  /// Position of a column. @throws InputError when the file lacks it
  int require(const std::string& column) const;

  /// Lines of the file: at least as many as it has rows.
  std::size_t line_count() const;

  /// Goes to the next row. False at the end.
  /// @throws InputError when the row has too few or too many values
  bool next();

  std::string_view cell(int column) const { return cells_[static_cast<std::size_t>(column)]; }
  /// A finite number. @throws InputError naming file, line, column and value
  double number(int column) const;
  /// "<file>: line L, column "x": <value> is not allowed: <expected>"
  [[noreturn]] void refuse(int column, const std::string& expected) const;
  [[noreturn]] void fail(const std::string& text) const;  ///< names file and line

 private:
  bool read_line();
  void split();

  std::filesystem::path file_;
  std::ifstream stream_;
  std::string line_;
  long long line_number_ = 0;
  std::vector<std::string> columns_;
  std::vector<std::string_view> cells_;
};

}  // namespace scree
