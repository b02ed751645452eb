#include "solvers/assembled/block_coloring.h"

#include <algorithm>

namespace scree {
namespace {

/// For every contact the ones below it that share a block with it, in either triangle.
struct LowerNeighbors {
  std::vector<std::size_t> start;
  std::vector<int> contact;

  explicit LowerNeighbors(const AssembledProblem& p) : start(p.contact_count + 1, 0) {
    for_pairs(p, [&](int above, int) { ++start[above + 1]; });
    for (int c = 0; c < p.contact_count; ++c) start[c + 1] += start[c];
    contact.resize(start.back());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for_pairs(p, [&](int above, int below) { contact[next[above]++] = below; });
  }

 private:
  template <class F>
  static void for_pairs(const AssembledProblem& p, F f) {
    for (int row = 0; row < p.contact_count; ++row)
      for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k)
        if (p.column[k] != row) f(std::max(row, p.column[k]), std::min(row, p.column[k]));
  }
};

}  // namespace

BlockColoring color_blocks(const AssembledProblem& p) {
  const LowerNeighbors neighbors(p);
  std::vector<int> color(p.contact_count);
  std::vector<int> taken_by;  // [color] the last contact that found it taken
  BlockColoring result;
  result.start.push_back(0);
  for (int c = 0; c < p.contact_count; ++c) {
    for (std::size_t k = neighbors.start[c]; k < neighbors.start[c + 1]; ++k)
      taken_by[color[neighbors.contact[k]]] = c;
    const auto free =
        std::find_if(taken_by.begin(), taken_by.end(), [&](int by) { return by != c; });
    color[c] = static_cast<int>(free - taken_by.begin());
    if (free == taken_by.end()) {
      taken_by.push_back(-1);
      result.start.push_back(0);
    }
    ++result.start[color[c] + 1];
  }
  for (std::size_t k = 1; k < result.start.size(); ++k) result.start[k] += result.start[k - 1];
  std::vector<Index> next(result.start.begin(), result.start.end() - 1);
  result.contact.resize(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c) result.contact[next[color[c]]++] = c;
  return result;
}

}  // namespace scree
