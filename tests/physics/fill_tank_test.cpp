// Rain fills a tank.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/physics/long_tests.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

// Spheres of 5 mm in 20 layers. The tank's side is 0.2 m for 1e5 spheres and scales with their
// number. Layers follow each other every 20 ms at 1 m/s, as closely as they can, and the run ends 1
// s after the last one: 2760 steps. The gate is on the deepest overlap of any step.
void expect_tank_fills(int count) {
  const int layers = 20, per_layer = count / layers;
  const double d = 5e-3, side = 0.2 * std::cbrt(count / 1e5), half = side / 2;
  Scene scene = empty_scene(5e-4, 0.3);
  scene.solver = SolverSettings{};
  add_tank(scene, -half, half, -half, half);
  const int across = static_cast<int>((side - d) / (1.05 * d)) + 1;
  const double spacing = (side - d) / (across - 0.5);
  for (int layer = 0; layer < layers; ++layer) {
    Scene batch;
    const double lowest = -0.5 * (across - 1) * spacing;
    add_lattice(batch, per_layer, across, across, {lowest, lowest, 0.17}, spacing, d / 2, 2500,
                static_cast<std::uint32_t>(layer + 1));
    for (BodyDescription& body : batch.bodies) body.velocity = {0, 0, -1};
    if (layer == 0) {
      for (const BodyDescription& body : batch.bodies) scene.bodies.push_back(body);
    } else {
      scene.insertions.push_back({0.02 * layer, batch.bodies});
    }
  }
  World world(scene, cpu_options(0, Precision::single_precision));
  double deepest = 0, iterations = 0, contacts = 0;
  int converged = 0;
  const int steps = steps_for(scene, 0.02 * (layers - 1) + 1.0);
  for (int k = 0; k < steps; ++k) {
    const StepReport report = world.step();
    deepest = std::max(deepest, report.max_penetration);
    iterations += report.iterations;
    contacts = report.contact_count;
    converged += report.converged;
  }
  std::vector<double> heights;
  const BodyStates s = world.states();
  for (std::size_t i = 5; i < s.position.size(); ++i) {
    const Vec3d x = s.position[i];
    heights.push_back(x.z);
    EXPECT_LE(std::max(std::abs(x.x), std::abs(x.y)), half - d / 2 + 0.01 * d) << "sphere " << i;
    EXPECT_GE(x.z, d / 2 - 0.01 * d) << "sphere " << i;
  }
  ASSERT_EQ(heights.size(), static_cast<std::size_t>(count));
  std::nth_element(heights.begin(), heights.begin() + count / 2, heights.end());
  const double below_median = count / 2 * kPi / 6 * d * d * d / (side * side * heights[count / 2]);
  testing::Test::RecordProperty("deepest_overlap_over_d", std::to_string(deepest / d));
  testing::Test::RecordProperty("mean_iterations", std::to_string(iterations / steps));
  testing::Test::RecordProperty("contacts_at_the_end", std::to_string(contacts));
  testing::Test::RecordProperty("solid_fraction_of_lower_half", std::to_string(below_median));
  testing::Test::RecordProperty("share_of_steps_converged",
                                std::to_string(static_cast<double>(converged) / steps));
  EXPECT_LT(deepest, 1e-2 * d);
  EXPECT_GT(below_median, 0.50);
  EXPECT_LT(below_median, 0.66);
}

TEST(FillTank, TwoThousandSpheresRainedInTwentyLayers) { expect_tank_fills(2000); }

TEST(FillTank, D01_TenThousandSpheresRainedInTwentyLayers) {
  if (!runs_long_tests()) GTEST_SKIP() << kLongTest;
  expect_tank_fills(10000);
}

}  // namespace
}  // namespace scree::physics
