// Springs that hold a light body which is joined to a heavy one: it is the heavy one that swings, and a spring takes no energy
// from it, as if it held that one itself.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/joint_scenes.h"
#include "tests/physics/weak_drives.h"

namespace scree::physics {
namespace {

constexpr double kFrame = 1.0 / 240, kHeavyMass = 1, kLightMass = 0.01, kOfSpring = 200,
                 kFirstSwing = 0.1;

/// How far the first body of a scene still swings along x in the second it does after so many others.
double swing_after(Scene scene, double seconds) {
  scene.gravity = {};
  World world(scene, cpu_options(1, Precision::double_precision));
  run_for(world, seconds);
  double most = 0;
  for (int k = 0; k < 240; ++k) {
    world.step();
    most = std::max(most, world.states().position[0].x);
  }
  return most;
}

/// A ball on a rail, beside it a chain of light ones that are fixed to it and to each other, and a spring from the last to the world.
Scene ball_with_light_ones(int count) {
  Scene scene = empty_scene(kFrame, 0);
  add_sphere(scene, {kFirstSwing, 0, 0}, 0.1, kHeavyMass);
  scene.joints.push_back(
      joint_of(JointKind::slider, kWorldBody, 0, {kFirstSwing, 0, 0}, {1, 0, 0}));
  for (int k = 1; k <= count; ++k) {
    const Vec3d at{kFirstSwing + 0.3 * k, 0, 0};
    add_sphere(scene, at, 0.02, kLightMass);
    scene.joints.push_back(joint_of(JointKind::fixed, k - 1, k, at));
  }
  const double end = 0.3 * count;
  Joint spring =
      line_of(JointKind::spring, kWorldBody, count, {end + 1, 0, 0}, {kFirstSwing + end, 0, 0});
  spring.length = 1;
  spring.stiffness = kOfSpring;
  scene.joints.push_back(spring);
  return scene;
}

TEST(JoinedSprings, ALightEndDoesNotDampThem) {
  // Four periods and some: the damping of a step is W^1.5 / 2 of critical damping, see docs/theory.md.
  const double alone = swing_after(ball_with_light_ones(0), 2);
  EXPECT_GT(alone, 0.98 * kFirstSwing);
  EXPECT_NEAR(swing_after(ball_with_light_ones(1), 2), alone, 0.01 * kFirstSwing);
  EXPECT_NEAR(swing_after(ball_with_light_ones(3), 2), alone, 0.01 * kFirstSwing);
}

TEST(JoinedSprings, NeitherDoesALightAxleOfAHeavyWheel) {
  Scene scene = empty_scene(kFrame, 0);
  scene.gravity = {};
  const double moment = add_box(scene, {0, 0.1, 0}, {0.2, 0.05, 0.2}, 3).inertia.y;
  add_box(scene, {}, {0.005, 0.05, 0.005}, 0.03);
  scene.joints.push_back(joint_of(JointKind::fixed, 0, 1, {0, 0.05, 0}));
  Joint hinge = joint_of(JointKind::hinge, kWorldBody, 1, {}, {0, 1, 0});
  constexpr double kTarget = 0.2;
  hinge.motor = JointMotor{.position = kTarget, .stiffness = 100 * moment};
  scene.joints.push_back(hinge);
  World world(scene, cpu_options(1, Precision::double_precision));
  run_for(world, 3);
  double top = 0, bottom = 1;
  for (int k = 0; k < 240; ++k) {
    world.step();
    const Vec3d x = rotate(world.states().orientation[0], {1, 0, 0});
    const double angle = std::atan2(-x.z, x.x);
    top = std::max(top, angle);
    bottom = std::min(bottom, angle);
  }
  EXPECT_NEAR(top, 2 * kTarget, 0.01 * kTarget);
  EXPECT_NEAR(bottom, 0, 0.01 * kTarget);
}

// One that is stiff for the heavy body, too, is still a rod: it does not ring.
TEST(JoinedSprings, StiffOnesAreStillRods) {
  Scene scene = ball_with_light_ones(1);
  scene.joints.back().stiffness = 1e7;
  EXPECT_LT(std::abs(swing_after(scene, 2)), 1e-6);
}

}  // namespace
}  // namespace scree::physics
