#pragma once
// What is to be drawn: lines in charts, charts in a figure. Plain data, without any drawing.

#include <limits>
#include <string>
#include <vector>

namespace scree {

/// Points joined in their order. A point that is not finite leaves a break.
struct Line {
  std::string name;  ///< in the legend; lines of one name look the same in all charts
  std::vector<double> x, y;
};

struct Axis {
  std::string label;
  bool is_log = true;  ///< values that are not positive then stand at a mark "0" below all others
  double most = std::numeric_limits<double>::infinity();  ///< larger values stand at this one
};

struct Chart {
  Axis x, y;
  std::vector<Line> lines;
};

/// Charts in rows, read like text, with one legend for all.
struct Figure {
  std::string title;
  int columns = 1;  ///< charts beside each other, > 0
  std::vector<Chart> charts;

  /// Names of the lines in the order of the legend, each once.
  std::vector<std::string> names() const;
};

}  // namespace scree
