#pragma once
// Tables in text files: a header line with column names, then one row a line.

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scree {

/// Lines of values with commas between them; spaces around values, empty lines and lines that start
/// with # are skipped.
class CsvLines {
 public:
  /// @param most_cells  of a line
  /// @throws InputError naming the file: missing or unreadable
  explicit CsvLines(std::filesystem::path file,
                    std::size_t most_cells = std::numeric_limits<std::size_t>::max());

  /// Goes to the next line. False at the end.
  bool next();
  const std::vector<std::string_view>& cells() const { return cells_; }
  /// A finite number; nothing where the cell is none.
  std::optional<double> number(std::size_t cell) const;
  /// "<file>: line L, <column>: <value> is not allowed: <expected>"
  [[noreturn]] void refuse(std::size_t cell, const std::string& column,
                           const std::string& expected) const;
  [[noreturn]] void fail(const std::string& text) const;  ///< names file and line
  const std::filesystem::path& file() const { return file_; }

 private:
  void split();

  std::filesystem::path file_;
  std::ifstream stream_;
  std::string line_;
  long long line_number_ = 0;
  std::vector<std::string_view> cells_;
  std::size_t most_cells_;
};

/// Reads a table with a header row by row.
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

  std::string_view cell(int column) const {
    return lines_.cells()[static_cast<std::size_t>(column)];
  }
  /// A finite number. @throws InputError naming file, line, column and value
  double number(int column) const;
  /// "<file>: line L, column "x": <value> is not allowed: <expected>"
  [[noreturn]] void refuse(int column, const std::string& expected) const;
  [[noreturn]] void fail(const std::string& text) const { lines_.fail(text); }

 private:
  std::string name_of(int column) const;  ///< as messages say it

  CsvLines lines_;
  std::vector<std::string> columns_;
};

}  // namespace scree
