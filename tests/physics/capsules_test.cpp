// Capsules: at rest, rolling, spinning free, on each other, and as walls for spheres.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/state_hash.h"
#include "tests/physics/round_bodies.h"

namespace scree::physics {
namespace {

constexpr double kRadius = 0.1;
constexpr double kLength = 0.4;
/// Those of these tests are alike.
BodyDescription standard_capsule(const Vec3d& position, const Quatd& orientation,
                                 double density = 1000) {
  return physics::capsule(position, orientation, kRadius, kLength, density);
}

/// Height of the lowest center of the first bodies [m].
double least_height(const BodyStates& s, int count) {
  double least = INFINITY;
  for (int i = 0; i < count; ++i)
    least = std::min(least, s.position[static_cast<std::size_t>(i)].z);
  return least;
}

TEST(Capsules, OneThatLiesHasAContactAtEachEndAndStays) {
  Scene scene = empty_scene(1e-2, 0.5);
  scene.bodies.push_back(standard_capsule({0, 0, kRadius}, kAlongX));
  add_plane(scene);
  World world = reference_world(scene);
  for (int k = 0; k < 200; ++k) {
    const StepReport report = world.step();
    ASSERT_EQ(report.contact_count, 2) << k;
    ASSERT_LT(report.kinetic_energy, 1e-15) << k;
  }
  EXPECT_NEAR(world.states().position[0].z, kRadius, 1e-9);
}

// A solid of revolution that rolls down a slope: a = g sin(theta) / (1 + I / (m r^2)). The contact
// moves over the round side, so nothing of its turning may act on the normal row.
TEST(Capsules, OneThatRollsDownASlopeHasTheAccelerationOfItsMoment) {
  constexpr double kAngle = 10, kStep = 1e-3;
  constexpr int kSteps = 1000;
  Scene scene = empty_scene(kStep, 0.8, Model::exact);
  tilt(scene, kAngle);
  scene.bodies.push_back(standard_capsule({0, 0, kRadius}, kAlongY));
  const BodyDescription body = scene.bodies[0];
  add_plane(scene);
  World world = reference_world(scene);
  for (int k = 0; k < kSteps; ++k) world.step();
  const BodyStates s = world.states();
  const double ratio = body.inertia.z / (body.mass * kRadius * kRadius);
  const double speed = kGravity * std::sin(radians(kAngle)) / (1 + ratio) * kStep * kSteps;
  EXPECT_NEAR(s.velocity[0].x, speed, 1e-6 * speed);
  EXPECT_NEAR(s.angular_velocity[0].y, speed / kRadius, 1e-6 * speed / kRadius);
  EXPECT_NEAR(s.position[0].z, kRadius, 1e-6);
  EXPECT_NEAR(s.velocity[0].y, 0, 1e-9);
}

TEST(Capsules, OneThatFallsOnAnEndComesToLie) {
  Scene scene = empty_scene(5e-3, 0.5);
  scene.bodies.push_back(standard_capsule({0, 0, 0.4}, exp_map(Vec3d{0.3, 0, 0})));
  add_plane(scene);
  World world = reference_world(scene);
  double deepest = 0;
  for (int k = 0; k < 1500; ++k) deepest = std::max(deepest, world.step().max_penetration);
  const BodyStates s = world.states();
  EXPECT_NEAR(s.position[0].z, kRadius, 1e-3);
  EXPECT_NEAR(rotate(s.orientation[0], Vec3d{0, 0, 1}).z, 0, 5e-3) << "its axis is level";
  EXPECT_LT(deepest, 1e-2 * kRadius);
}

// Layers of two, each across the one below: four crossings a layer.
TEST(Capsules, ACribOfThemStands) {
  constexpr int kLayers = 4;
  Scene scene = empty_scene(1e-2, 0.5);
  for (int layer = 0; layer < kLayers; ++layer) {
    const double z = kRadius * (2 * layer + 1);
    for (const double side : {-0.15, 0.15}) {
      const bool is_along_x = layer % 2 == 0;
      scene.bodies.push_back(is_along_x ? standard_capsule({0, side, z}, kAlongX)
                                        : standard_capsule({side, 0, z}, kAlongY));
    }
  }
  add_plane(scene);
  World world = reference_world(scene);
  double energy = 0;
  StepReport report;
  for (int k = 0; k < 300; ++k) {
    report = world.step();
    energy = std::max(energy, report.kinetic_energy);
  }
  EXPECT_EQ(report.contact_count, 2 * 2 + 4 * (kLayers - 1));
  EXPECT_LT(energy, 1e-9);
  const BodyStates s = world.states();
  for (std::size_t i = 0; i < 2 * kLayers; ++i)
    EXPECT_LT(norm(s.position[i] - scene.bodies[i].position), 1e-5) << i;
}

TEST(Capsules, SpheresRestInTheGrooveOfTwoThatAreFixed) {
  Scene scene = empty_scene(5e-3, 0.3);
  for (const double side : {-0.12, 0.12}) {
    BodyDescription rail = standard_capsule({0, side, 0}, kAlongX);
    rail.kind = BodyKind::fixed;
    rail.mass = 0;
    rail.inertia = {};
    scene.bodies.push_back(rail);
  }
  constexpr double r = 0.1;
  const double rest = std::sqrt((r + kRadius) * (r + kRadius) - 0.12 * 0.12);
  add_sphere(scene, {0, 0.01, rest + 0.02}, r, 1);
  World world = reference_world(scene);
  StepReport report;
  for (int k = 0; k < 2000; ++k) report = world.step();
  EXPECT_EQ(report.contact_count, 2);
  const BodyStates s = world.states();
  EXPECT_NEAR(s.position[2].z, rest, 1e-4);
  EXPECT_NEAR(s.position[2].y, 0, 1e-3);
}

TEST(Capsules, FastSpheresDoNotPassThroughFixedOnes) {
  expect_stops_a_fast_sphere(standard_capsule({0, 0, 0}, kAlongX));
}

TEST(Capsules, AMixedPileHasTheSameBitsOnAnyNumberOfThreads) {
  Scene scene = empty_scene(5e-3, 0.4);
  solve_to(scene, 1e-7);
  scene.solver.max_iterations = 200;
  for (int k = 0; k < 24; ++k) {
    const Vec3d at{0.65 * (k % 3 - 1) + 0.01 * (k % 5), 0.65 * (k / 3 % 3 - 1),
                   0.4 + 0.65 * (k / 9)};
    if (k % 2 == 0)
      scene.bodies.push_back(standard_capsule(at, exp_map(Vec3d{0.4 * k, 0.3, 0.2 * k})));
    else
      add_sphere(scene, at, 0.08, 2);
  }
  add_tank(scene, -1, 1, -1, 1);
  World one(scene, cpu_options(1)), two(scene, cpu_options(2));
  double deepest = 0;
  for (int k = 0; k < 300; ++k) {
    deepest = std::max(deepest, one.step().max_penetration);
    two.step();
  }
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
  EXPECT_LT(deepest, 0.1 * kRadius);
  EXPECT_GT(least_height(one.states(), 24), 0.07);
}

}  // namespace
}  // namespace scree::physics
