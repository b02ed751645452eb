// A pile of 10192 spheres settled by somebody else's engine (Kleinert 2015) goes on standing in
// this one: no rotations, friction 0.4, gravity 10, floor z = 0.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/physics/scene_builder.h"
#include "tests/physics/shared_data.h"

namespace scree::physics {
namespace {

/// Height below which 99 % of the centers lie, which a few loose grains on top do not move, and the
/// RMS distance of the centers from the pile's axis, which grows when the foot of the pile creeps
/// outward.
struct PileSize {
  double height = 0;
  double spread = 0;
};
PileSize size_of(const std::vector<Vec3d>& centers, std::size_t count) {
  Vec3d mean;
  std::vector<double> heights;
  for (std::size_t i = 0; i < count; ++i) {
    mean += 1.0 / static_cast<double>(count) * centers[i];
    heights.push_back(centers[i].z);
  }
  PileSize size;
  for (std::size_t i = 0; i < count; ++i)
    size.spread += std::pow(centers[i].x - mean.x, 2) + std::pow(centers[i].y - mean.y, 2);
  size.spread = std::sqrt(size.spread / static_cast<double>(count));
  const auto at = heights.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(count));
  std::nth_element(heights.begin(), at, heights.end());
  size.height = *at;
  return size;
}

TEST(KleinertPile, StandsForTwoSeconds) {
  const auto path = shared_file("kleinert/particles10192pile.csv");
  const auto rows = number_rows(shared_text(path));
  if (rows.empty()) GTEST_SKIP() << "cannot read " << path;
  Scene scene = empty_scene(4e-3, 0.4);
  scene.gravity = {0, 0, -10};
  scene.solver = SolverSettings{};
  for (const auto& r : rows) {
    ASSERT_EQ(r.size(), 8u);
    BodyDescription& body = add_sphere(scene, {r[0], r[1], r[2]}, r[6], r[7]);
    body.velocity = {r[3], r[4], r[5]};
    body.locks = lock_rotation;
  }
  add_plane(scene);
  ASSERT_EQ(rows.size(), 10192u);

  World world(scene, cpu_options(0, Precision::single_precision));
  const PileSize before = size_of(world.states().position, rows.size());
  StepReport report = run_for(world, scene, 2);
  const PileSize after = size_of(world.states().position, rows.size());
  RecordProperty("height_ratio", std::to_string(after.height / before.height));
  RecordProperty("spread_ratio", std::to_string(after.spread / before.spread));
  RecordProperty("kinetic_energy", std::to_string(report.kinetic_energy));
  RecordProperty("contacts", report.contact_count);
  EXPECT_NEAR(after.height / before.height, 1, 0.02);
  EXPECT_NEAR(after.spread / before.spread, 1, 0.02);
}

}  // namespace
}  // namespace scree::physics
