// What redundant joints of a mechanism bear while contacts keep the solver at work.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

struct Redundant : testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(Precisions, Redundant,
                         testing::Values(Precision::double_precision, Precision::single_precision),
                         [](const auto& of) {
                           return of.param == Precision::double_precision ? "Double" : "Float";
                         });

/// A thin bar in the plane y = 0 from one point to another.
int add_bar(Scene& scene, const Vec3d& from, const Vec3d& to) {
  constexpr double kWide = 0.006, kHigh = 0.01, kDensity = 2700;
  const Vec3d along = to - from;
  const double half = 0.5 * norm(along), angle = std::atan2(-along.z, along.x);
  add_box(scene, 0.5 * (from + to), {half, kWide, kHigh}, kDensity * 8 * half * kWide * kHigh)
      .orientation = {std::cos(angle / 2), 0, std::sin(angle / 2), 0};
  return last_id(scene);
}

/// Three bars between two hinges of the world, of which a motor turns one, above balls that lie and roll on the ground.
Scene linkage_above_balls(int balls) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver.stop = StopRule();
  const Vec3d start{-0.2, 0, 0.55}, pin{-0.3, 0, 0.55}, knee{-0.15, 0, 0.35}, end{0, 0, 0.55};
  const Vec3d axis{0, 1, 0}, aside{0, 0.007, 0};  // bars lie side by side, joints between them
  const int crank = add_bar(scene, start - aside, pin - aside);
  const int coupler = add_bar(scene, pin + aside, 2.0 * knee - pin + aside);
  const int rocker = add_bar(scene, end - aside, knee - aside);
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, crank, start, axis));
  scene.joints.back().motor = JointMotor{.speed = 3, .max_force = 60};
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, rocker, end, axis));
  scene.joints.push_back(joint_of(JointKind::hinge, crank, coupler, pin, axis));
  // Sideways, it holds what the three hinges hold already.
  scene.joints.push_back(joint_of(JointKind::ball, rocker, coupler, knee));
  for (int k = 0; k < balls; ++k) {
    add_sphere(scene, {0.017 * (k % 8) - 0.1, 0.017 * (k / 8), 0.008}, 0.008, 0.005).velocity = {
        0.3 * (k % 3) - 0.3, 0.1, 0};
  }
  add_plane(scene);
  return scene;
}

// Nothing loads it sideways but couples of bars that lie side by side.
TEST_P(Redundant, ALinkageBearsFewNewtonsAcrossItsPlane) {
  World world(linkage_above_balls(40), cpu_options(1, GetParam()));
  double largest = 0, in_plane = 0;
  int iterations = 0;
  for (int k = 0; k < 300; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged) << k;
    iterations += report.iterations;
    for (const JointRecord& joint : world.joints()) {
      largest = std::max(largest, std::abs(joint.force.y) / 1e-3);
      in_plane = std::max(in_plane, std::abs(joint.force.x) / 1e-3);
    }
  }
  EXPECT_GT(iterations, 300);
  EXPECT_GT(in_plane, 1);
  EXPECT_LT(largest, 3);  // in the jerk of the start
}

// The solver adds the weight of balls to what the step before left; the hinges share that, too, in each step.
TEST_P(Redundant, HingesShareWhatContactsAddInAStep) {
  Scene scene = empty_scene(1e-3, 0);
  scene.solver.stop = StopRule();
  add_box(scene, {0.5, 0, 1}, {0.5, 0.1, 0.02}, 10);
  for (const double side : {-0.08, 0.08})
    scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 0, {0, side, 1}, {0, 1, 0}));
  scene.joints.back().motor = JointMotor{.speed = 0, .max_force = 1000};
  // From above, on one side.
  add_sphere(scene, {0.9, 0.05, 1.0401}, 0.02, 2).velocity = {0, 0, -2};
  World world(scene, cpu_options(1, GetParam()));
  double struck = 0;
  for (int k = 0; k < 20; ++k) {
    world.step();
    const auto joints = world.joints();
    const double load = std::abs(joints[0].force.z + joints[1].force.z) / 1e-3;
    struck = std::max(struck, load);
    EXPECT_NEAR(joints[0].moment.x, joints[1].moment.x, 1e-3 * load * 1e-3) << k;
    EXPECT_NEAR(joints[0].force.x, joints[1].force.x, 1e-3 * load * 1e-3) << k;
  }
  EXPECT_GT(struck, 1000);
}

}  // namespace
}  // namespace scree::physics
