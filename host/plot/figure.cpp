#include "host/plot/figure.h"

#include <algorithm>

namespace scree {

std::vector<std::string> Figure::names() const {
  std::vector<std::string> names;
  for (const Chart& chart : charts)
    for (const Line& line : chart.lines)
      if (std::find(names.begin(), names.end(), line.name) == names.end())
        names.push_back(line.name);
  return names;
}

}  // namespace scree
