#pragma once
// Morton codes and the cells of the broad phase.

#include <random>
#include <set>

#include "kernels/bin_plan.h"
#include "kernels/morton.h"
#include "tests/unit/backend_fixture.h"

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
    EXPECT_EQ(spread_bits_10(x), spread_bits(x & 0x3ffu));
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
    const Index bodies = 1 + static_cast<Index>(random() % 5000);
    BinLevel l;
    plan_level(extent, period, bodies, 0.7, l);
    std::set<Index> numbers;
    for (Index z = 0; z < l.cells[2]; ++z) {
      for (Index y = 0; y < l.cells[1]; ++y) {
        for (Index x = 0; x < l.cells[0]; ++x) {
          numbers.insert(cell_part(l, 0, x) + cell_part(l, 1, y) + cell_part(l, 2, z));
        }
      }
    }
    EXPECT_EQ(numbers.size(), static_cast<std::size_t>(l.cells[0]) * l.cells[1] * l.cells[2]);
    EXPECT_GE(*numbers.begin(), 0);
    EXPECT_LT(*numbers.rbegin(), level_cells(l));
    EXPECT_LE(level_cells(l), 4 * std::max(bodies, 32))
        << "the table stays in proportion to the bodies";
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(l.edge[k] >= 0.7 || l.cells[k] == 1) << "only a period shorter than a cell";
      if (period[k] > 0) {
        const double wraps = period[k] / l.wrap[k];
        EXPECT_NEAR(wraps, std::round(wraps), 1e-9) << "a period is a whole number of wraps";
      }
    }
  }
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
