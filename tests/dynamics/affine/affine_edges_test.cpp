// What users met at the edges of affine scenes: where bodies begin, where steps end, and what stays where it is.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/dynamics/affine_scenes.h"

namespace scree::affine {
namespace {

using namespace test;
using physics::add_box;
using physics::add_plane;

World run_for(const Scene& scene, int steps) {
  World world(scene, cpu_options());
  for (int k = 0; k < steps; ++k) world.step();
  return world;
}

// The barrier of a short step is stiff: a cube in the middle of a reach that fits the size of the scene would leave at 18 m/s.
TEST(AffineEdges, WhatBeginsNearAWallIsNotThrownOff) {
  for (const double gap : {1e-3, 5e-3}) {
    Scene scene = affine_scene(1e-3, 0);
    physics::add_wall_box(scene, {0, 0, -0.05}, {5, 5, 0.05});
    add_box(scene, {0, 0, 0.05 + gap}, {0.05, 0.05, 0.05}, 1);
    World world(scene, cpu_options());
    EXPECT_THAT(world.warnings(), ::testing::IsEmpty());
    for (int k = 0; k < 300; ++k) {
      world.step();
      ASSERT_LT(world.states().position[1].z, 0.05 + 2 * gap) << gap << ", step " << k;
    }
    scene.dynamics.parameters["reach"] = 0.014;
    EXPECT_THAT(World(scene, cpu_options()).warnings(),
                ::testing::ElementsAre(::testing::StartsWith(
                    "body 1 and body 0 start 0.00" + std::to_string(static_cast<int>(1e3 * gap)) +
                    " m apart, within the reach of 0.014 m")));
  }
}

// A reach that fits the size of the scene alone would be larger than the cube.
TEST(AffineEdges, ACubeRestsOnAWideFloorAsOnANarrowOne) {
  for (const double half : {0.5, 500.0}) {
    Scene scene = affine_scene(0.01, 0);
    physics::add_wall_box(scene, {0, 0, -0.05}, {half, half, 0.05});
    add_box(scene, {0, 0, 0.25}, {0.05, 0.05, 0.05}, 1);
    World world(scene, cpu_options());
    for (int k = 0; k < 100; ++k) world.step();
    const double gap = world.states().position[1].z - 0.05;
    EXPECT_GT(gap, 0) << half;
    EXPECT_LT(gap, 0.002) << half;
  }
}

// Near a barrier Newton steps are as short as gaps. Where they are below the tolerance, but ever longer, no step has ended.
TEST(AffineEdges, ABallFallsAlikeWhereverItFalls) {
  std::vector<double> height[2];
  for (const int place : {0, 1}) {
    Scene scene = affine_scene(0.01, 0, 1);
    add_plane(scene);
    physics::add_sphere(scene, {10.0 * place, 0, 0.3}, 0.1, 4);
    World world(scene, cpu_options());
    for (int k = 0; k < 60; ++k) {
      EXPECT_TRUE(world.step().converged) << k;
      height[place].push_back(world.states().position[1].z);
    }
  }
  for (std::size_t k = 0; k < 60; ++k) EXPECT_NEAR(height[0][k], height[1][k], 1e-3) << k;
  EXPECT_LT(*std::max_element(height[0].begin() + 25, height[0].end()), 0.105);
}

// What ends Newton's method must not grow with floors and with bodies far away: friction changes a velocity by as little.
TEST(AffineEdges, BlocksSlideAlikeOnFloorsOfAnySize) {
  constexpr double kFriction = 0.3, kSlope = 25;
  for (const double size : {1.0, 20.0, 100.0}) {
    SCOPED_TRACE(size);
    Scene scene = affine_scene(0.01, kFriction, 1);
    physics::tilt(scene, kSlope);
    physics::add_wall_box(scene, {0, 0, -0.5}, {size, size, 0.5});
    add_box(scene, {0, 0, 0.1005}, {0.1, 0.1, 0.1}, 8);
    World world(scene, cpu_options());
    for (int k = 0; k < 30; ++k) world.step();
    const double before = world.states().velocity[1].x;
    for (int k = 0; k < 30; ++k) world.step();
    const double angle = physics::radians(kSlope);
    const double expected =
        physics::kGravity * (std::sin(angle) - kFriction * std::cos(angle)) * 0.3;
    EXPECT_NEAR(world.states().velocity[1].x - before, expected, 0.02 * expected);
  }
}
TEST(AffineEdges, TorquesActAlikeBesideBodiesFarAway) {
  Scene scene = affine_scene(0.01, 0, 1);
  scene.gravity = {};
  add_box(scene, {}, {0.1, 0.1, 0.1}, 8).load = Load{{}, {0, 0, 0.01}};
  physics::add_wall_box(scene, {50, 0, 0}, {0.1, 0.1, 0.1});
  World world(scene, cpu_options());
  for (int k = 0; k < 200; ++k) world.step();
  const double expected = 2 * 0.01 / (8 * 0.04 / 6);
  EXPECT_NEAR(world.states().angular_velocity[0].z, expected, 0.02 * expected);
}

// A body of some micrometers is so stiff that it stops turning: a run says so before. Of other sizes it keeps its spin.
TEST(AffineEdges, BodiesThatAreTooStiffToTurnAreNamed) {
  for (const double size : {5e-6, 2e-3, 1.0}) {
    Scene scene = affine_scene(0.01, 0, 1);
    scene.gravity = {};
    add_box(scene, {}, {size, size, 2 * size}, 1.6e4 * std::pow(size, 3)).angular_velocity = {5, 0,
                                                                                              0};
    World world(scene, cpu_options());
    if (size < 1e-5) {
      EXPECT_THAT(world.warnings(),
                  ::testing::ElementsAre(::testing::StartsWith("body 0 is very stiff")));
      continue;
    }
    EXPECT_THAT(world.warnings(), ::testing::IsEmpty());
    for (int k = 0; k < 100; ++k) EXPECT_TRUE(world.step().converged) << size << ", step " << k;
    EXPECT_NEAR(world.states().angular_velocity[0].x, 5, 0.1) << size;
  }
}

TEST(AffineEdges, MotionsBeginWhereTheirSamplesDo) {
  Scene scene = affine_scene(0.01, 0);
  scene.gravity = {};
  Motion motion;
  motion.kind = Motion::Kind::sampled;
  motion.times = {0, 1};
  motion.positions = {{2, 0, 0}, {2, 0, 0}};
  physics::add_wall_box(scene, {-1, 0, 0}, {0.05, 0.5, 0.5}, BodyKind::kinematic).motion = motion;
  add_box(scene, {}, {0.1, 0.1, 0.1}, 8);
  World world(scene, cpu_options());
  EXPECT_NEAR(world.states().position[0].x, 1, 1e-12);
  for (int k = 0; k < 20; ++k) world.step();
  EXPECT_NEAR(world.states().position[0].x, 1, 1e-9);
  EXPECT_EQ(world.states().position[1], Vec3d{});
}

// A press is blocked by a box on the floor. A table far from it, which bears ten tons, stays where it is.
TEST(AffineEdges, BlockedBodiesStay) {
  Scene scene = affine_scene(0.01, 0.5);
  add_plane(scene);
  add_box(scene, {3, 0, 1.452}, {0.4, 0.4, 0.4}, 1e4);
  add_box(scene, {0, 0, 0.102}, {0.1, 0.1, 0.1}, 8);
  add_pusher(scene, {3, 0, 1}, {0.5, 0.5, 0.05}, {});
  add_pusher(scene, {0, 0, 0.26}, {0.1, 0.1, 0.05}, {0, 0, -0.2});
  World world(scene, cpu_options());
  double before = 0;
  StepReport report;
  for (int k = 0; k < 150; ++k) {
    report = world.step();
    if (k == 99) before = world.states().position[3].z;
  }
  EXPECT_GT(report.own[blocked], 0);
  EXPECT_NEAR(before, 1, 4e-3);
  EXPECT_NEAR(world.states().position[3].z, before, 1e-5);
}

TEST(AffineEdges, HalfSpacesAreWhereBodiesAre) {
  Scene scene = affine_scene(0.01, 0);
  add_plane(scene);
  add_box(scene, {4e5, 5e6, 0.6}, {0.5, 0.5, 0.5}, 1000);
  const World world = run_for(scene, 100);
  EXPECT_GT(world.states().position[1].z, 0.5);
  EXPECT_LT(world.states().position[1].z, 0.7);
}

}  // namespace
}  // namespace scree::affine
