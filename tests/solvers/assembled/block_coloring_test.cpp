#include "solvers/assembled/block_coloring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace scree {
namespace {

AssembledProblem with_blocks(int contact_count, const std::vector<std::pair<int, int>>& places) {
  std::vector<PlacedBlock> blocks;
  blocks.reserve(places.size());
  for (const auto& [row, column] : places) blocks.push_back({row, column, {1}});
  return assemble(contact_count, blocks, std::vector<double>(3 * contact_count, 0.0),
                  std::vector<double>(contact_count, 0.5));
}

std::vector<int> colors_of(const BlockColoring& coloring) {
  std::vector<int> color(coloring.contact.size(), -1);
  for (int k = 0; k < coloring.color_count(); ++k)
    for (int i = coloring.start[k]; i < coloring.start[k + 1]; ++i) color[coloring.contact[i]] = k;
  return color;
}

TEST(BlockColoring, ContactsThatTouchDiffer) {
  std::mt19937 generator(3);
  std::uniform_int_distribution<int> any(0, 199);
  std::vector<std::pair<int, int>> places;
  places.reserve(800);
  for (int k = 0; k < 800; ++k) places.emplace_back(any(generator), any(generator));
  const AssembledProblem p = with_blocks(200, places);  // its pattern is not symmetric
  const BlockColoring coloring = color_blocks(p);
  const std::vector<int> color = colors_of(coloring);
  EXPECT_EQ(std::count(color.begin(), color.end(), -1), 0);
  for (const auto& [row, column] : places)
    if (row != column) {
      EXPECT_NE(color[row], color[column]) << row << " " << column;
    }
  for (int k = 0; k < coloring.color_count(); ++k)
    EXPECT_TRUE(std::is_sorted(coloring.contact.begin() + coloring.start[k],
                               coloring.contact.begin() + coloring.start[k + 1]));
}

TEST(BlockColoring, TakesTheFirstFreeColor) {
  // A star and, apart from it, a contact alone.
  const BlockColoring star = color_blocks(with_blocks(5, {{0, 1}, {2, 0}, {0, 3}}));
  EXPECT_EQ(colors_of(star), (std::vector<int>{0, 1, 1, 1, 0}));
  const BlockColoring triangle = color_blocks(with_blocks(3, {{0, 1}, {1, 2}, {2, 0}}));
  EXPECT_EQ(colors_of(triangle), (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace scree
