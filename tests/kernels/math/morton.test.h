#pragma once
// Morton codes and the cells of the broad phase.

#include <random>
#include <set>

#include "kernels/broad_phase/bin_plan.h"
#include "kernels/math/morton.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

TEST(MortonTest, InterleavesBits) {
  EXPECT_EQ(morton_code(1, 0, 0), 1u);
  EXPECT_EQ(morton_code(0, 1, 0), 2u);
  EXPECT_EQ(morton_code(0, 0, 1), 4u);
  EXPECT_EQ(morton_code(3, 5, 6), 0b110'101'011u + 0u) << "bits z y x of each position";
  EXPECT_EQ(morton_code(kMortonMask, kMortonMask, kMortonMask), (1ull << 60) - 1);
}

TEST(MortonTest, GatherInvertsSpread) {
  std::mt19937 random(1);
  for (int k = 0; k < 1000; ++k) {
    const auto x = static_cast<std::uint32_t>(random()) & kMortonMask;
    EXPECT_EQ(gather_bits(spread_bits(x)), x);
  }
}

TEST(MortonTest, SpreadsBitsInAPlane) {
  for (std::uint32_t x = 0; x < 256; ++x) {
    std::uint32_t expected = 0;
    for (unsigned k = 0; k < 8; ++k) expected |= (x >> k & 1) << 2 * k;
    EXPECT_EQ(spread_bits_plane(x), expected);
    EXPECT_EQ(spread_bits_plane(x | 0x500), expected) << "higher bits are left out";
  }
}

TEST(MortonTest, CoordinatesWrap) {
  EXPECT_EQ(morton_code(kMortonMask + 6, 2, 3), morton_code(5, 2, 3));
}

/// Levels of random shape: every cell has a number of its own inside the table.
TEST(BinPlanTest, CellNumbersAreUnique) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> log_extent(-1, 2.5);
  for (int trial = 0; trial < 40; ++trial) {
    BodyExtent extent;
    Vec3<double> period;
    for (int k = 0; k < 3; ++k) {
      extent.lower[k] = -1;
      extent.upper[k] = -1 + std::pow(10.0, log_extent(random));
      if (trial & (1 << k)) period[k] = extent.upper[k] + 1.5;
    }
    const double limit = cell_limit(1 + static_cast<Index>(random() % 5000), 6000);
    BinLevel l;
    l.first_cell = 17;
    plan_level(extent, period, limit, 0.7, l);
    std::set<Index> numbers;
    for (Index z = 0; z < l.cells[2]; ++z) {
      for (Index y = 0; y < l.cells[1]; ++y) {
        for (Index x = 0; x < l.cells[0]; ++x) {
          numbers.insert(first_of_row(l, y, z) + x - l.first_cell);
        }
      }
    }
    EXPECT_EQ(numbers.size(), static_cast<std::size_t>(l.cells[0]) * l.cells[1] * l.cells[2]);
    EXPECT_GE(*numbers.begin(), 0);
    EXPECT_LT(*numbers.rbegin(), level_cells(l));
    EXPECT_LE(level_cells(l), 1.5625 * limit) << "the table stays in proportion to the bodies";
    for (int k = 0; k < 3; ++k) {
      const double least = k == 0 ? 0.7 / kCellsPerEdge : 0.7;
      EXPECT_TRUE(l.edge[k] >= least || l.cells[k] == 1) << "only a period shorter than a cell";
      if (period[k] > 0) {
        const double wraps = period[k] / l.wrap[k];
        EXPECT_NEAR(wraps, std::round(wraps), 1e-9) << "a period is a whole number of wraps";
      }
    }
  }
}

TEST(BinPlanTest, CellsOfAllLevelsFitAnIndex) {
  for (const double total : {1e3, 1e6, 1e9, 2e9}) {
    double cells = 0;
    for (int level = 0; level < kMaxLevels; ++level)
      cells += cell_limit(static_cast<Index>(total / kMaxLevels), total);
    EXPECT_LE(cells, std::max(5 * total, 64.0 * kMaxLevels));
    EXPECT_LT(1.5625 * cells, 2147483648.0);
  }
}

/// Levels of one, two, four... times the diameter 1 in a cube of edge 50.
BinGrid grid_of(const std::vector<Index>& bodies) {
  BodyExtent extent;
  LevelCounts counts;
  for (int k = 0; k < 3; ++k) {
    extent.lower[k] = 0;
    extent.upper[k] = 50;
  }
  extent.max_diameter = std::ldexp(1.0, static_cast<int>(bodies.size()) - 1);
  for (std::size_t k = 0; k < bodies.size(); ++k) counts.count[k] = bodies[k];
  const double edge = 1;
  BinGrid grid;
  PlanBins{&extent, &edge, {}, &grid}(counts);
  return grid;
}

TEST(BinPlanTest, FewLargeBodiesLookForSmallOnes) {
  const BinGrid grid = grid_of({100000, 10000, 1000, 0, 10});
  ASSERT_EQ(grid.level_count, 4);
  EXPECT_EQ(grid.level[0].searched, 0u);
  EXPECT_EQ(grid.level[1].searched, 0b1u);
  EXPECT_EQ(grid.level[2].searched, 0b11u);
  EXPECT_EQ(grid.level[3].searched, 0b110u) << "too much work for one body in the finest level";
  EXPECT_EQ(grid.level[1].first_slice, 0);
  EXPECT_EQ(grid.level[2].first_slice, 10000 * slices_of_body(grid.level[1], grid.level[0]));
  EXPECT_GE(slices_of_body(grid.level[1], grid.level[0]), 4);
  EXPECT_LE(slices_of_body(grid.level[1], grid.level[0]), 5);
}

TEST(BinPlanTest, ManyLargeBodiesAreLookedFor) {
  EXPECT_EQ(grid_of({10000, 10000, 10000}).slice_count, 0);
}

TEST(BinPlanTest, FinestEdgeHoldsTheSmallestBodies) {
  for (const double diameter : {1e-6, 0.01, 0.7, 1.0, 3.1}) {
    BodyExtent e;
    e.min_diameter = e.max_diameter = diameter;
    e.phase_count[edge_phase(diameter)] = 10;
    const double edge = finest_edge(e);
    EXPECT_GE(edge, diameter);
    EXPECT_LE(edge, 1.05 * diameter);
  }
}

}  // namespace
}  // namespace scree
