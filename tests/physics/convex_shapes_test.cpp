// Hulls, cones and ellipsoids: standing, sliding, rolling, tipping, and in piles with all other shapes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/scene/convex_hull.h"
#include "shapes/cone.h"
#include "shapes/ellipsoid.h"
#include "shapes/hull.h"
#include "tests/physics/floors.h"
#include "tests/physics/round_bodies.h"

namespace scree::physics {
namespace {

BodyDescription solid(ShapeKind kind, const Vec3d& position, const Quatd& orientation,
                      const Vec3d& half_extents) {
  BodyDescription body;
  body.shape.kind = kind;
  body.shape.half_extents = half_extents;
  body.position = position;
  body.orientation = orientation;
  set_mass_from_density(body, 1000);
  return body;
}
BodyDescription cone(const Vec3d& position, const Quatd& orientation, double radius,
                     double length) {
  return solid(shapes::Cone::kind, position, orientation, {radius, radius, 0.75 * length});
}
BodyDescription ellipsoid(const Vec3d& position, const Quatd& orientation, const Vec3d& half) {
  return solid(shapes::Ellipsoid::kind, position, orientation, half);
}

BodyDescription& add_hull(Scene& scene, const Vec3d& position, const Quatd& orientation,
                          const std::vector<Vec3d>& points) {
  BodyDescription body;
  body.position = position;
  body.orientation = orientation;
  set_hull(scene, body, points);
  set_mass_from_density(body, 1000);
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

constexpr Floor kFloors[] = {Floor::plane, Floor::box, Floor::mesh, Floor::hull};

TEST(ConvexBodies, RestOnEveryFloor) {
  for (const Floor floor : kFloors) {
    SCOPED_TRACE(static_cast<int>(floor));
    Scene scene = empty_scene(1e-2, 0.5);
    solve_to(scene, 1e-10);
    scene.bodies.push_back(cone({-1, 0.1, 0.1}, exp_map(Vec3d{0, 0, 0.3}), 0.2, 0.4));
    scene.bodies.push_back(ellipsoid({0, 0.1, 0.1}, {}, {0.3, 0.2, 0.1}));
    add_hull(scene, {1, 0.1, 0.15}, exp_map(Vec3d{0, 0, 0.7}), box_points({0.2, 0.1, 0.15}));
    add_floor(scene, floor, 3);
    World world = reference_world(scene);
    for (int k = 0; k < 100; ++k) {
      const StepReport report = world.step();
      ASSERT_EQ(report.contact_count, 4 + 1 + 4) << k;
      ASSERT_LT(report.kinetic_energy, 1e-12) << k;
    }
    for (const int id : {0, 1}) EXPECT_NEAR(world.states().position[id].z, 0.1, 1e-7);
    EXPECT_NEAR(world.states().position[2].z, 0.15, 1e-7);
  }
}

// The closed form of a block that slides: a = g (sin(theta) - mu cos(theta)).
TEST(ConvexBodies, AHullThatSlidesDownASlopeHasTheAccelerationOfABlock) {
  constexpr double kStep = 1e-3, kFriction = 0.3;
  for (const Floor floor : kFloors) {
    SCOPED_TRACE(static_cast<int>(floor));
    Scene scene = empty_scene(kStep, kFriction, Model::exact);
    tilt(scene, 25);
    add_hull(scene, {-1, 0.1, 0.05}, exp_map(Vec3d{0, 0, 0.7}), box_points({0.2, 0.1, 0.05}));
    add_floor(scene, floor, 3);
    World world = reference_world(scene);
    for (int k = 0; k < 400; ++k) world.step();
    const double expected =
        kGravity * (std::sin(radians(25)) - kFriction * std::cos(radians(25))) * 400 * kStep;
    EXPECT_NEAR(world.states().velocity[0].x, expected, 1e-6 * expected);
  }
}

// A prism of many sides rolls nearly as a cylinder does: it loses a part of its energy at each side, all together as 1 / sides.
TEST(ConvexBodies, AHullOfManySidesRollsDownASlopeAsACylinder) {
  constexpr double kStep = 1e-3, kRadius = 0.1;
  constexpr int kSides = 240;
  std::vector<Vec3d> points;
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * kPi * k / kSides;
    for (const double z : {-0.2, 0.2})
      points.push_back({kRadius * std::cos(angle), kRadius * std::sin(angle), z});
  }
  Scene scene = empty_scene(kStep, 0.8, Model::exact);
  solve_to(scene, 1e-9);
  tilt(scene, 10);
  add_hull(scene, {0, 0, kRadius}, kAlongY, points);
  add_plane(scene);
  World world = reference_world(scene);
  for (int k = 0; k < 500; ++k) world.step();
  const double cylinder = 2.0 / 3 * kGravity * std::sin(radians(10)) * 500 * kStep;
  EXPECT_NEAR(world.states().velocity[0].x, cylinder, 0.03 * cylinder);
}

// An ellipsoid whose axes are equal is a ball: 5/7 of the acceleration.
TEST(ConvexBodies, ARoundEllipsoidRollsDownASlopeAsABall) {
  constexpr double kStep = 1e-3;
  for (const Floor floor : kFloors) {
    SCOPED_TRACE(static_cast<int>(floor));
    Scene scene = empty_scene(kStep, 0.8, Model::exact);
    tilt(scene, 10);
    scene.bodies.push_back(
        ellipsoid({-0.5, 0, 0.1}, exp_map(Vec3d{0.3, 0.2, 0.1}), {0.1, 0.1, 0.1}));
    add_floor(scene, floor, 3);
    World world = reference_world(scene);
    for (int k = 0; k < 300; ++k) world.step();
    const double ball = 5.0 / 7 * kGravity * std::sin(radians(10)) * 300 * kStep;
    EXPECT_NEAR(world.states().velocity[0].x, ball, 1e-4 * ball);
  }
}

// However far it turns within a step.
TEST(ConvexBodies, RollingEllipsoidsTouchTheFloor) {
  const struct {
    Vec3d half;
    double radius;  // m, that it rolls on; 0: end over end
  } kRolling[] = {{{0.05, 0.05, 0.25}, 0.05}, {{0.2, 0.2, 0.1}, 0.2}, {{0.12, 0.1, 0.08}, 0}};
  for (const Floor floor : {Floor::plane, Floor::box}) {
    for (const auto& [half, radius] : kRolling) {
      SCOPED_TRACE(std::to_string(half.z) + " " + std::to_string(static_cast<int>(floor)));
      Scene scene = empty_scene(1.0 / 120, 0.5);
      add_floor(scene, floor, 10);
      // Its symmetry axis, or the second one, along y.
      const Quatd upright = radius > 0 ? exp_map(Vec3d{kPi / 2, 0, 0}) : Quatd{};
      const double speed = radius > 0 ? 40 * radius : 1;
      scene.bodies.push_back(ellipsoid({0, 0, radius > 0 ? radius : half.z}, upright, half));
      scene.bodies.back().velocity = {speed, 0, 0};
      scene.bodies.back().angular_velocity = {0, speed / (radius > 0 ? radius : half.z), 0};
      World world = reference_world(scene);
      double most = 0;
      for (int k = 0; k < 120; ++k) {
        world.step();
        const BodyStates s = world.states();
        const Vec3d down = rotate_back(s.orientation.back(), Vec3d{0, 0, -1});
        const double height = dot(down, shapes::Ellipsoid::extreme(half, down));
        most = std::max(most, std::abs(s.position.back().z - height));
      }
      EXPECT_LT(most, 2e-3 * half.z);
      if (radius > 0) {
        EXPECT_NEAR(world.states().velocity.back().x, speed, 1e-3 * speed);
      }
    }
  }
}

// The long axis of an ellipsoid that lies and is tipped a little rocks about the short axis with w^2 = m g s / (I + m c^2),
// s = a^2 / c - c: the lever arm of the contact for a small angle.
TEST(ConvexBodies, AnEllipsoidRocksWithItsOwnPeriod) {
  constexpr double kStep = 5e-4, a = 0.2, c = 0.1;
  Scene scene = empty_scene(kStep, 1.0, Model::exact);
  solve_to(scene, 1e-10);
  const double angle = 0.02;
  const double height = std::sqrt(a * a * std::sin(angle) * std::sin(angle) +
                                  c * c * std::cos(angle) * std::cos(angle));
  scene.bodies.push_back(ellipsoid({0, 0, height}, exp_map(Vec3d{0, angle, 0}), {a, 0.15, c}));
  add_plane(scene);
  const double inertia = 0.2 * (a * a + c * c);  // of a unit mass
  const double w = std::sqrt(kGravity * (a * a / c - c) / (inertia + c * c));
  World world = reference_world(scene);
  const auto tilt_now = [&] { return rotate(world.states().orientation[0], Vec3d{1, 0, 0}).z; };
  double before = tilt_now();
  std::vector<double> crossings;
  for (int k = 1; crossings.size() < 5 && k < 8000; ++k) {
    world.step();
    const double now = tilt_now();
    if (before * now < 0) crossings.push_back((k - now / (now - before)) * kStep);
    before = now;
  }
  ASSERT_EQ(crossings.size(), 5u);
  EXPECT_NEAR((crossings[4] - crossings[0]) / 2, 2 * kPi / w, 0.01 * 2 * kPi / w);
}

// It tips when the line of gravity leaves its base: tan(theta) = R / (L / 4). So near to that, it rocks first, from one point of
// its rim to the next, and larger steps than these let it fall.
TEST(ConvexBodies, AConeOnASlopeStandsUntilItsCenterIsOverItsRim) {
  constexpr double kRadius = 0.05, kLength = 0.3;
  const double limit = std::atan(kRadius / (kLength / 4)) * 180 / kPi;
  for (const double beyond : {-0.7, 0.7}) {
    Scene scene = empty_scene(1e-3, 0.9);
    solve_to(scene, 1e-9);
    tilt(scene, limit + beyond);
    scene.bodies.push_back(cone({0, 0, kLength / 4}, exp_map(Vec3d{0, 0, 0.4}), kRadius, kLength));
    add_plane(scene);
    World world = reference_world(scene);
    for (int k = 0; k < 2000; ++k) world.step();
    const double upright = rotate(world.states().orientation[0], Vec3d{0, 0, 1}).z;
    if (beyond < 0) {
      EXPECT_GT(upright, 0.999);
    } else {
      EXPECT_LT(upright, 0.9);
    }
  }
}

TEST(ConvexBodies, TenHullsStandOnEachOther) {
  Scene scene = empty_scene(5e-3, 0.5);
  solve_to(scene, 1e-8);
  for (int k = 0; k < 10; ++k)
    add_hull(scene, {0, 0, 0.05 + 0.1 * k}, exp_map(Vec3d{0, 0, 0.05 * k}),
             box_points({0.08, 0.06, 0.05}));
  add_plane(scene);
  World world = reference_world(scene);
  for (int k = 0; k < 400; ++k) world.step();
  for (int k = 0; k < 10; ++k) {
    const Vec3d x = world.states().position[static_cast<std::size_t>(k)];
    EXPECT_LT(norm(x - Vec3d{0, 0, 0.05 + 0.1 * k}), 1e-4) << k;
  }
}

TEST(ConvexBodies, APileOfAllShapesComesToRestWithTheSameBitsOnAnyNumberOfThreads) {
  Scene scene = empty_scene(5e-3, 0.5);
  solve_to(scene, 1e-6);
  scene.solver.max_iterations = 300;
  std::vector<Vec3d> rock;
  for (int k = 0; k < 14; ++k) {
    const double z = 1 - 2 * (k + 0.5) / 14, angle = 2.4 * k, r = std::sqrt(1 - z * z);
    rock.push_back({0.06 * r * std::cos(angle), 0.05 * r * std::sin(angle), 0.04 * z});
  }
  for (int k = 0; k < 54; ++k) {
    const Vec3d at{0.2 * (k % 3 - 1) + 0.01 * (k % 5), 0.2 * (k / 3 % 3 - 1), 0.1 + 0.2 * (k / 9)};
    const Quatd turn = exp_map(Vec3d{0.4 * k, 0.3, 0.2 * k});
    switch (k % 7) {
      case 0:
        add_box(scene, at, {0.06, 0.05, 0.04}, 1).orientation = turn;
        break;
      case 1:
        scene.bodies.push_back(capsule(at, turn, 0.04, 0.08));
        break;
      case 2:
        scene.bodies.push_back(cylinder(at, turn, 0.05, 0.1));
        break;
      case 3:
        scene.bodies.push_back(cone(at, turn, 0.06, 0.11));
        break;
      case 4:
        scene.bodies.push_back(ellipsoid(at, turn, {0.06, 0.05, 0.035}));
        break;
      case 5:
        add_hull(scene, at, turn, rock);
        break;
      default:
        add_sphere(scene, at, 0.05, 0.5);
    }
  }
  add_tank(scene, -0.3, 0.3, -0.3, 0.3);
  // Nothing slows a ball that rolls on the floor: one of 0.5 kg at 0.1 m/s has 4 mJ.
  const BodyStates states = expect_pile_rests(scene, 1000, 1e-2);
  for (const Vec3d& x : states.position) EXPECT_GT(x.z, -1e-3);
}

// It would cross any of them in one step.
TEST(ConvexBodies, FastSpheresDoNotPassThroughFixedOnes) {
  for (const ShapeKind kind : {shapes::Cone::kind, shapes::Ellipsoid::kind, shapes::Hull::kind}) {
    Scene scene = empty_scene(1e-2, 0.3);
    scene.gravity = {};
    BodyDescription rail;
    if (kind == shapes::Hull::kind) {
      set_hull(scene, rail, box_points({0.3, 0.1, 0.1}));
    } else {
      // The base of the cone is above, where the others have their top.
      const Quatd turn = exp_map(Vec3d{kPi, 0, 0});
      rail = solid(kind, {}, turn, {0.2, 0.2, kind == shapes::Cone::kind ? 0.3 : 0.1});
    }
    rail.kind = BodyKind::fixed;
    rail.mass = 0;
    rail.inertia = {};
    scene.bodies.push_back(rail);
    add_sphere(scene, {0, 0.01, 0.5}, 0.05, 1).velocity = {0, 0, -60};
    World world = reference_world(scene);
    for (int k = 0; k < 3; ++k) {
      world.step();
      EXPECT_GT(world.states().position[1].z, 0.14) << shape_card(kind).name;
    }
  }
}

}  // namespace
}  // namespace scree::physics
