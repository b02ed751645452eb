#include "host/cli/bench/table.h"

#include <fmt/format.h>

#include "host/io/streams.h"

namespace scree {

void Table::row(const std::vector<std::string>& cells) {
  if (!has_heading_) {
    std::vector<std::string> names;
    for (const Column& column : columns_) names.push_back(column.name);
    print(names);
    has_heading_ = true;
  }
  print(cells);
}

void Table::print(const std::vector<std::string>& cells) const {
  std::string line;
  for (std::size_t k = 0; k < cells.size(); ++k)
    line += fmt::format("{}{:>{}}", k == 0 ? "" : " ", cells[k], columns_.at(k).width);
  fmt::print("{}\n", line);
  finish_output();
}

std::string digits(double value, int count) { return fmt::format("{:.{}g}", value, count); }
std::string fixed(double value, int decimals) { return fmt::format("{:.{}f}", value, decimals); }

}  // namespace scree
