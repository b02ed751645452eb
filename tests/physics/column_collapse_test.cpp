// A column of grains as high as its radius spreads by 1.24 of its radius (Lube et al. 2004).

#include <gtest/gtest.h>

#include "tests/physics/column.h"

namespace scree::physics {
namespace {

TEST(ColumnCollapse, C32_RunOutOfAColumnAsHighAsItsRadius) {
  const Column column = cut_column(800);
  const Scene scene = column_scene(column, 5e-4);
  World world(scene, cpu_options(0));
  run_for(world, scene, 0.5);  // experiments stop after 3 sqrt(H / g) = 0.24 s
  const double spread = run_out(column, world.states().position);
  RecordProperty("run_out", std::to_string(spread));
  EXPECT_GT(spread, 0.9);
  EXPECT_LT(spread, 1.9);
}

}  // namespace
}  // namespace scree::physics
