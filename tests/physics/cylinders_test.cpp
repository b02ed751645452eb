// Cylinders: standing, lying, rolling, spinning, tipping, and in piles with other shapes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/described_bodies.h"
#include "tests/physics/round_bodies.h"

namespace scree::physics {
namespace {

/// A level square of two triangles.
void add_mesh_square(Scene& scene, double half) {
  TriangleMesh mesh;
  mesh.name = "square";
  mesh.closed = false;
  mesh.vertices = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_mesh(scene, mesh);
}

enum class CylinderFloor { plane, box, mesh };
void add_cylinder_floor(Scene& scene, CylinderFloor floor) {
  if (floor == CylinderFloor::plane) add_plane(scene);
  if (floor == CylinderFloor::box) add_wall_box(scene, {0, 0, -1}, {3, 3, 1});
  if (floor == CylinderFloor::mesh) add_mesh_square(scene, 3.1);
}

TEST(Cylinders, RestStandingOnFourPointsAndLyingOnTwo) {
  for (const CylinderFloor floor :
       {CylinderFloor::plane, CylinderFloor::box, CylinderFloor::mesh}) {
    for (const bool is_standing : {true, false}) {
      Scene scene = empty_scene(1e-2, 0.5);
      scene.bodies.push_back(is_standing ? cylinder({0.3, 0.1, 0.2}, {}, 0.1, 0.4)
                                         : cylinder({0.3, 0.1, 0.1}, kAlongX, 0.1, 0.4));
      add_cylinder_floor(scene, floor);
      World world = reference_world(scene);
      for (int k = 0; k < 100; ++k) {
        const StepReport report = world.step();
        ASSERT_EQ(report.contact_count, is_standing ? 4 : 2) << k;
        ASSERT_LT(report.kinetic_energy, 1e-14) << k;
      }
      EXPECT_NEAR(world.states().position[0].z, is_standing ? 0.2 : 0.1, 1e-8);
    }
  }
}

// Bodies rest two centimeters within the round rim of a plate, where it is outside of the eight points that stand for it. Some lie on
// it with a face, of others one point is deepest.
TEST(Cylinders, WhatRestsWithinTheRimOfAPlateStaysThere) {
  struct Resting {
    const char* shape;
    double height;
  };
  const Resting kBodies[] = {{R"("shape": "ellipsoid", "size": [0.1, 0.1, 0.06])", 0.03},
                             {R"("shape": "cone", "radius": 0.015, "length": 0.04)", 0.01},
                             {R"("shape": "cylinder", "radius": 0.015, "length": 0.02)", 0.01},
                             {R"("shape": "box", "size": [0.02, 0.02, 0.02])", 0.01}};
  for (
      const char* plate :
      {R"("shape": "cylinder", "radius": 0.5, "length": 0.2, "position": [0, 0, -0.1])",
       R"("shape": "cone", "radius": 0.5, "length": 0.4, "position": [0, 0, -0.1], "orientation": [0, 1, 0, 0])"}) {
    for (const Resting& body : kBodies) {
      Scene scene = empty_scene(1e-3, 0.5);
      BodyDescription& fixed = add_described(scene, plate);
      fixed.kind = BodyKind::fixed;
      fixed.mass = 0;
      fixed.inertia = {};
      for (int k = 0; k < 16; ++k) {
        const double angle = 2 * kPi * k / 16, rho = 0.48;
        BodyDescription& b = add_described(scene, body.shape);
        b.position = {rho * std::cos(angle), rho * std::sin(angle), body.height};
      }
      World world = reference_world(scene);
      for (int k = 0; k < 200; ++k) world.step();
      const BodyStates states = world.states();
      for (std::size_t i = 1; i < states.position.size(); ++i) {
        EXPECT_LT(norm(states.position[i] - scene.bodies[i].position), 1e-4)
            << plate << body.shape << i;
        EXPECT_LT(norm(states.angular_velocity[i]), 1e-2) << plate << body.shape << i;
      }
    }
  }
}

// A solid of revolution that rolls down a slope: a = g sin(theta) / (1 + I / (m r^2)), with 2/3 of a cylinder.
TEST(Cylinders, OneThatRollsDownASlopeHasTwoThirdsOfTheAcceleration) {
  constexpr double kStep = 1e-3;
  constexpr int kSteps = 500;
  for (const CylinderFloor floor :
       {CylinderFloor::plane, CylinderFloor::box, CylinderFloor::mesh}) {
    Scene scene = empty_scene(kStep, 0.8, Model::exact);
    tilt(scene, 10);
    scene.bodies.push_back(cylinder({0, 0, 0.1}, kAlongY, 0.1, 0.4));
    add_cylinder_floor(scene, floor);
    World world = reference_world(scene);
    for (int k = 0; k < kSteps; ++k) world.step();
    const BodyStates s = world.states();
    const double speed = 2.0 / 3 * kGravity * std::sin(radians(10)) * kStep * kSteps;
    EXPECT_NEAR(s.velocity[0].x, speed, 1e-5 * speed);
    EXPECT_NEAR(s.angular_velocity[0].y, speed / 0.1, 1e-5 * speed / 0.1);
    EXPECT_NEAR(s.position[0].z, 0.1, 1e-6);
  }
}

// Support at the rim alone: the torque is mu m g R and the moment m R^2 / 2.
TEST(Cylinders, AFlatDiscThatSpinsIsSlowedByItsRim) {
  constexpr double kRadius = 0.1, kFriction = 0.3, kStep = 1e-3;
  constexpr int kSteps = 300;
  for (const CylinderFloor floor : {CylinderFloor::plane, CylinderFloor::box}) {
    Scene scene = empty_scene(kStep, kFriction, Model::exact);
    scene.bodies.push_back(cylinder({0, 0, 0.005}, {}, kRadius, 0.01));
    scene.bodies[0].angular_velocity = {0, 0, 30};
    add_cylinder_floor(scene, floor);
    World world = reference_world(scene);
    for (int k = 0; k < kSteps; ++k) world.step();
    const BodyStates s = world.states();
    const double rate = 30 - 2 * kFriction * kGravity / kRadius * kStep * kSteps;
    EXPECT_NEAR(s.angular_velocity[0].z, rate, 0.02 * (30 - rate));
    EXPECT_NEAR(s.position[0].z, 0.005, 1e-6);
    EXPECT_LT(norm(s.velocity[0]), 1e-3);
  }
}

// It tips when the line of gravity leaves its base: tan(theta) = R / (L / 2).
// By Coulomb's law itself: convex friction lifts a rim that slides, which feeds a wobble, and within half a degree of the
// limit a cylinder may tip after seconds.
TEST(Cylinders, OneOnASlopeStandsUntilItsCenterIsOverItsRim) {
  constexpr double kRadius = 0.05, kLength = 0.3;
  const double limit = std::atan(kRadius / (kLength / 2)) * 180 / kPi;
  for (const double turn : {0.0, 0.2, 0.4, 0.7}) {
    for (const double beyond : {-0.5, 0.5}) {
      Scene scene = empty_scene(5e-3, 0.8, Model::exact);
      solve_to(scene, 1e-9);
      tilt(scene, limit + beyond);
      scene.bodies.push_back(
          cylinder({0, 0, kLength / 2}, exp_map(Vec3d{0, 0, turn}), kRadius, kLength));
      add_plane(scene);
      World world = reference_world(scene);
      for (int k = 0; k < 600; ++k) world.step();
      const double upright = rotate(world.states().orientation[0], Vec3d{0, 0, 1}).z;
      if (beyond < 0) {
        EXPECT_GT(upright, 0.999) << turn;
      } else {
        EXPECT_LT(upright, 0.9) << turn;
      }
    }
  }
}

TEST(Cylinders, APileWithBoxesAndCapsulesComesToRestWithTheSameBitsOnAnyNumberOfThreads) {
  Scene scene = empty_scene(5e-3, 0.5);
  solve_to(scene, 1e-6);
  scene.solver.max_iterations = 300;
  for (int k = 0; k < 36; ++k) {
    const Vec3d at{0.2 * (k % 3 - 1) + 0.01 * (k % 5), 0.2 * (k / 3 % 3 - 1), 0.1 + 0.2 * (k / 9)};
    const Quatd turn = exp_map(Vec3d{0.4 * k, 0.3, 0.2 * k});
    if (k % 4 == 0) {
      add_box(scene, at, {0.06, 0.05, 0.04}, 1).orientation = turn;
    } else if (k % 4 == 1) {
      scene.bodies.push_back(capsule(at, turn, 0.04, 0.08));
    } else if (k % 4 == 2) {
      scene.bodies.push_back(cylinder(at, turn, 0.05, 0.1));
    } else {
      add_sphere(scene, at, 0.05, 0.5);
    }
  }
  add_tank(scene, -0.3, 0.3, -0.3, 0.3);
  // Spheres roll on the others for seconds, since nothing resists that, and may fall off late.
  expect_pile_rests(scene, 1200, 1e-3);
}

TEST(Cylinders, FastSpheresDoNotPassThroughFixedOnes) {
  expect_stops_a_fast_sphere(cylinder({0, 0, 0}, kAlongX, 0.1, 0.4));
}

}  // namespace
}  // namespace scree::physics
