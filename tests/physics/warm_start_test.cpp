// What steps start from: the mean of the impulses that contacts had.

#include <gtest/gtest.h>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// Spheres of 1 cm that fall into a box, in the precision of runs.
Scene resting_bed() {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver = SolverSettings{};
  scene.gravity = {0, 0, -kGravity};
  add_tank(scene, -0.035, 0.035, -0.035, 0.035);
  add_lattice(scene, 400, 6, 6, {-0.027, -0.027, 0.006}, 0.0105, 0.005, 2500, 1);
  return scene;
}

// From the impulses of the last step alone these steps take 7 iterations, since what a solve leaves comes back as gaps.
TEST(WarmStart, ABedAtRestTakesFewIterations) {
  World world(resting_bed(), cpu_options(1, Precision::single_precision));
  for (int k = 0; k < 1500; ++k) world.step();
  constexpr int kSteps = 1000;
  double iterations = 0;
  for (int k = 0; k < kSteps; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged);
    iterations += report.iterations;
  }
  EXPECT_LT(iterations / kSteps, 5);
}

// The mean is for the solver: contacts have the impulses that were found.
TEST(WarmStart, ContactsHaveTheImpulsesOfTheirStep) {
  Scene scene = empty_scene(1e-3, 0.5);
  solve_to(scene, 1e-10);
  scene.gravity = {0, 0, -kGravity};
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.1}, 0.1, 2);
  World world = reference_world(scene);
  for (int k = 0; k < 10; ++k) world.step();
  world.set_gravity({0, 0, -3 * kGravity});
  world.step();
  const std::vector<ContactRecord> contacts = world.contacts();
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(std::abs(contacts[0].impulse.z), 3 * 2 * kGravity * 1e-3, 1e-9);
  const double kept = std::abs(world.save().at<Vec3d>("contact/impulse").at(0).z);
  EXPECT_GT(kept, 1.1 * 2 * kGravity * 1e-3) << "the next step starts from a mean";
  EXPECT_LT(kept, 2.9 * 2 * kGravity * 1e-3);
}

}  // namespace
}  // namespace scree::physics
