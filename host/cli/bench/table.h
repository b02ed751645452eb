#pragma once
// A table on standard output, printed line by line while a benchmark runs.

#include <string>
#include <vector>

namespace scree {

class Table {
 public:
  struct Column {
    std::string name;
    int width = 10;  ///< [characters]; longer cells push the line out
  };
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// Prints one line, the heading before the first. Cells are aligned to the right.
  void row(const std::vector<std::string>& cells);

 private:
  void print(const std::vector<std::string>& cells) const;

  std::vector<Column> columns_;
  bool has_heading_ = false;
};

/// A number with so many significant digits, without trailing noise: "1.23e+08", "12.3".
std::string digits(double value, int count = 3);
/// A number with so many decimals.
std::string fixed(double value, int decimals);

}  // namespace scree
