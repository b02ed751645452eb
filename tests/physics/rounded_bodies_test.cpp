// Rounded bodies: at rest on every floor, rolling over their edges, in stacks and piles, as walls and as parts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/compounds.h"
#include "host/hulls.h"
#include "host/state_hash.h"
#include "shapes/cone.h"
#include "shapes/cylinder.h"
#include "shapes/ellipsoid.h"
#include "shapes/rounded.h"
#include "tests/physics/floors.h"
#include "tests/physics/round_bodies.h"

namespace scree::physics {
namespace {

using shapes::Rounded;

Shape rounded(ShapeKind kind, const Vec3d& half_extents, double radius) {
  Shape core;
  core.kind = kind;
  core.half_extents = half_extents;
  return Rounded::of(core, radius);
}
BodyDescription body_of(const Shape& shape, const Vec3d& position, const Quatd& orientation = {}) {
  BodyDescription body;
  body.shape = shape;
  body.position = position;
  body.orientation = orientation;
  set_mass_from_density(body, 1000);
  return body;
}
BodyDescription rounded_box(const Vec3d& position, const Vec3d& half, double radius,
                            const Quatd& orientation = {}) {
  return body_of(rounded(shapes::Box::kind, half, radius), position, orientation);
}
BodyDescription fixed(BodyDescription body) {
  body.kind = BodyKind::fixed;
  body.mass = 0;
  body.inertia = {};
  return body;
}

constexpr Floor kRoundedFloors[] = {Floor::plane, Floor::box, Floor::mesh, Floor::hull,
                                    Floor::rounded_box};

// Half of the core and the radius: at each floor to the digits of the solve. They fall a little first.
TEST(RoundedBodies, RestOnEveryFloorAtHalfTheirCoreAndTheRadius) {
  constexpr double kRadius = 0.03, kFall = 1e-3;
  for (const Floor floor : kRoundedFloors) {
    SCOPED_TRACE(static_cast<int>(floor));
    Scene scene = empty_scene(1e-2, 0.5);
    solve_to(scene, 1e-10);
    const Quatd turn = exp_map(Vec3d{0, 0, 0.3});
    std::vector<double> expected;
    const auto add = [&](BodyDescription body, double height) {
      body.position.z = height + kFall;
      expected.push_back(height);
      scene.bodies.push_back(body);
    };
    add(rounded_box({-2, 0.1, 0}, {0.2, 0.1, 0.15}, kRadius, turn), 0.15 + kRadius);
    add(body_of(rounded(shapes::Cylinder::kind, {0.2, 0.2, 0.1}, kRadius), {-1, 0.1, 0}, turn),
        0.1 + kRadius);
    const Shape cone = rounded(shapes::Cone::kind, {0.2, 0.2, 0.3}, kRadius);
    // Its center of mass is above that of the cone: its base lies as deep below it as the card says.
    add(body_of(cone, {0, 0.1, 0}, turn), 0.1 - cone.rounded.shift + kRadius);
    add(body_of(rounded(shapes::Ellipsoid::kind, {0.3, 0.2, 0.1}, kRadius), {1, 0.1, 0}),
        0.1 + kRadius);
    BodyDescription hull;
    hull.position = {2, 0.1, 0};
    hull.orientation = turn;
    set_hull(scene, hull, box_points({0.2, 0.1, 0.15}), kRadius);
    set_mass_from_density(hull, 1000);
    add(hull, 0.15 + kRadius);
    add_floor(scene, floor, 4);
    World world = reference_world(scene);
    StepReport report;
    for (int k = 0; k < 100; ++k) report = world.step();
    EXPECT_LT(report.kinetic_energy, 1e-12);
    const BodyStates states = world.states();
    for (std::size_t id = 0; id < expected.size(); ++id) {
      SCOPED_TRACE(id);
      EXPECT_NEAR(states.position[id].z, expected[id], 1e-6);
      EXPECT_NEAR(states.position[id].x, scene.bodies[id].position.x, 1e-6);
    }
  }
}

// A cone that stands on its rounded point, held upright, is found from above a mesh, too.
TEST(RoundedBodies, AConeOnItsPointRestsOnEveryFloor) {
  for (const double radius : {0.0, 0.02}) {
    for (const Floor floor : kRoundedFloors) {
      SCOPED_TRACE(static_cast<int>(floor));
      Scene scene = empty_scene(1e-2, 0.5);
      Shape cone;
      cone.kind = shapes::Cone::kind;
      cone.half_extents = {0.1, 0.1, 0.3};
      if (radius > 0) cone = Rounded::of(cone, radius);
      const double height = cone.half_extents.z;
      BodyDescription body = body_of(cone, {0.3, 0.1, height + 1e-3}, exp_map(Vec3d{kPi, 0, 0}));
      body.locks = lock_rotation;
      scene.bodies.push_back(body);
      add_floor(scene, floor, 4);
      World world = reference_world(scene);
      for (int k = 0; k < 50; ++k) world.step();
      EXPECT_NEAR(world.states().position[0].z, height, 1e-6);
    }
  }
}

// It falls over its rounded edge, which rolls: energy gives its rate of turning. The distance from the point of contact to the
// center of mass has the square r^2 + L^2 + 2 r L sin(a).
TEST(RoundedBodies, ABoxRollsOverItsRoundedEdge) {
  constexpr double kHalf = 0.1, kRadius = 0.04, kStep = 2e-4;
  const double arm = kHalf * std::sqrt(2.0);
  for (const Floor floor : {Floor::plane, Floor::box, Floor::mesh}) {
    SCOPED_TRACE(static_cast<int>(floor));
    Scene scene = empty_scene(kStep, 2.0, Model::exact);
    solve_to(scene, 1e-9);
    // The edge is below the center at the start but for 8 degrees, to which it falls.
    const double start = radians(82);
    const double turned = kPi / 4 - start;  // from where it would stand flat
    BodyDescription box =
        rounded_box({}, {kHalf, kHalf, kHalf}, kRadius, exp_map(Vec3d{0, turned, 0}));
    box.position = {0, 0, kRadius + arm * std::sin(start)};
    const double moment = box.inertia.y, mass = box.mass;
    scene.bodies.push_back(box);
    add_floor(scene, floor, 4);
    World world = reference_world(scene);
    const double first = 0;
    double sine = std::sin(start), rate = 0, place = 0;
    for (int k = 0; k < 4000 && sine > std::sin(radians(52)); ++k) {
      world.step();
      const BodyStates s = world.states();
      sine = (s.position[0].z - kRadius) / arm;
      rate = std::abs(s.angular_velocity[0].y);
      place = s.position[0].x;
    }
    ASSERT_LT(sine, std::sin(radians(52)));
    const double inertia =
        moment + mass * (kRadius * kRadius + arm * arm + 2 * kRadius * arm * sine);
    const double expected =
        std::sqrt(2 * mass * kGravity * arm * (std::sin(start) - sine) / inertia);
    EXPECT_NEAR(rate, expected, 2e-3 * expected);
    // The edge has rolled by the radius times the angle; the center is beside it by the arm.
    const double angle = start - std::asin(sine);
    const double way = kRadius * angle + arm * (std::cos(std::asin(sine)) - std::cos(start));
    EXPECT_NEAR(std::abs(place - first), way, 2e-3 * way);
  }
}

// Ten boxes stand on each other; contacts are found again in each step and start from their impulses.
TEST(RoundedBodies, AStackOfBoxesStands) {
  constexpr int n = 10;
  constexpr double kEdge = 0.1, kRadius = 0.01;
  const Vec3d half{kEdge / 2 - kRadius, kEdge / 2 - kRadius, kEdge / 2 - kRadius};
  Scene scene = empty_scene(1e-2, 0.5);
  solve_to(scene, 1e-10);
  for (int k = 0; k < n; ++k)
    scene.bodies.push_back(rounded_box({0, 0, kEdge * (k + 0.5)}, half, kRadius));
  add_plane(scene);
  World world = reference_world(scene);
  int unsolved = 0, late_iterations = 0;
  for (int k = 0; k < 300; ++k) {
    const StepReport report = world.step();
    unsolved += !report.converged;
    if (k >= 200) late_iterations = std::max(late_iterations, report.iterations);
    ASSERT_EQ(report.contact_count, 4 * n) << "step " << k;
    ASSERT_LT(report.max_penetration, 1e-4);
  }
  EXPECT_EQ(unsolved, 0);
  EXPECT_LT(norm(world.states().position[n - 1] - Vec3d{0, 0, kEdge * (n - 0.5)}), 1e-4);
  const double weight = world.constants()[0].mass * kGravity * scene.stepping.time_step;
  double sum = 0;
  for (const ContactRecord& c : world.contacts())
    if (c.body_a == n || c.body_b == n) sum += dot(c.impulse, c.normal);
  EXPECT_NEAR(std::abs(sum), n * weight, 1e-4 * n * weight);
  EXPECT_LT(late_iterations, 200);
}

// All shapes, rounded or not, in a box: they come to rest without deep overlaps, with the same bits on two threads.
TEST(RoundedBodies, PilesOfAllShapesRest) {
  Scene scene = empty_scene(4e-3, 0.5);
  scene.solver.stop = {};
  scene.materials[0].rolling_friction = 5e-4;  // else ellipsoids rock on their bellies for long
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int count = 0;
  const auto add = [&](BodyDescription body) {
    body.position = {0.12 * (count % 3 - 1), 0.12 * (count / 3 % 3 - 1), 0.1 + 0.14 * (count / 9)};
    const double x = normal(random), y = normal(random), z = normal(random);
    body.orientation = normalized(Quatd(normal(random), x, y, z));
    set_mass_from_density(body, 1000);
    scene.bodies.push_back(body);
    ++count;
  };
  for (int round = 0; round < 3; ++round) {
    for (const auto& [kind, half] :
         {std::pair{shapes::Box::kind, Vec3d{0.03, 0.02, 0.02}},
          std::pair{shapes::Cylinder::kind, Vec3d{0.025, 0.025, 0.02}},
          std::pair{shapes::Cone::kind, Vec3d{0.03, 0.03, 0.03}},
          std::pair{shapes::Ellipsoid::kind, Vec3d{0.03, 0.02, 0.015}}}) {
      add(body_of(rounded(kind, half, 0.01), {}));
      Shape sharp;
      sharp.kind = kind;
      sharp.half_extents = half + Vec3d{0.01, 0.01, 0.01};
      if (kind != shapes::Ellipsoid::kind) add(body_of(sharp, {}));
    }
    BodyDescription hull;
    set_hull(scene, hull, {{0, 0, 0}, {0.06, 0, 0}, {0, 0.06, 0}, {0, 0, 0.06}, {0.04, 0.04, 0.03}},
             0.01);
    add(hull);
    BodyDescription ball = sphere({}, 0.03, 1);
    add(ball);
  }
  add_tank(scene, -0.2, 0.2, -0.2, 0.2);
  World one(scene, cpu_options(1)), two(scene, cpu_options(2));
  double deepest = 0, late = 0;
  constexpr int kSteps = 700;
  for (int k = 0; k < kSteps; ++k) {
    const StepReport report = one.step();
    two.step();
    if (k > kSteps / 2) deepest = std::max(deepest, report.max_penetration);
    if (k > kSteps - 50) late = std::max(late, report.kinetic_energy);
  }
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
  EXPECT_LT(deepest, 1e-3);
  EXPECT_LT(late, 1e-4);
  for (int id = 0; id < count; ++id) EXPECT_GT(one.states().position[id].z, 0.015) << id;
}

TEST(RoundedBodies, AFixedOneStopsAFastSphere) {
  expect_stops_a_fast_sphere(rounded_box({}, {0.5, 0.05, 0.05}, 0.05));
  expect_stops_a_fast_sphere(
      body_of(rounded(shapes::Cylinder::kind, {0.06, 0.06, 0.5}, 0.04), {}, kAlongX));
}

TEST(RoundedBodies, AKinematicOneLiftsWhatLiesOnIt) {
  Scene scene = empty_scene(1e-2, 0.5);
  scene.bodies.push_back(rounded_box({0, 0, 0.5 + 0.1}, {0.1, 0.1, 0.08}, 0.02));
  add_sphere(scene, {0.7, 0, 0.5 + 0.05}, 0.05, 1);
  BodyDescription table = fixed(rounded_box({0, 0, 0.25}, {1, 1, 0.2}, 0.05));
  table.kind = BodyKind::kinematic;
  Motion motion;
  motion.kind = Motion::Kind::linear;
  motion.velocity = {0, 0, 0.3};
  table.motion = motion;
  scene.bodies.push_back(table);
  World world = reference_world(scene);
  for (int k = 0; k < 100; ++k) world.step();
  EXPECT_NEAR(world.states().position[0].z, 0.6 + 0.3, 1e-6);
  EXPECT_NEAR(world.states().position[1].z, 0.55 + 0.3, 1e-6);
}

// A part alone is the body itself, a part that lies within another adds nothing, and parts carry their body.
TEST(RoundedBodies, AsPartsOfCompounds) {
  Scene scene = empty_scene(1e-2, 0.5);
  const BodyDescription box = rounded_box({}, {0.2, 0.1, 0.15}, 0.03);
  ShapePart part;
  part.shape = box.shape;
  part.position = {0.5, 0.2, 0.1};
  BodyDescription one;
  set_compound(scene, one, {part});
  set_mass_from_density(one, 1000);
  EXPECT_NEAR(one.mass, box.mass, 1e-10 * box.mass);
  EXPECT_LT(norm(one.position - part.position), 1e-12);
  EXPECT_NEAR(norm(one.inertia - box.inertia), 0, 1e-10);
  BodyDescription twice;
  set_compound(scene, twice, {part, part});
  set_mass_from_density(twice, 1000);
  EXPECT_NEAR(twice.mass, box.mass, 1e-4 * box.mass);

  BodyDescription hull;
  set_hull(scene, hull, box_points({0.2, 0.1, 0.15}), 0.03);
  ShapePart second;
  second.shape = hull.shape;
  part.position = {-0.4, 0, 0};
  second.position = {0.4, 0, 0};
  BodyDescription body;
  body.position = {0, 0, 0.181};
  set_compound(scene, body, {part, second});
  set_mass_from_density(body, 1000);
  EXPECT_NEAR(body.mass, 2 * box.mass, 1e-10 * box.mass);
  EXPECT_NEAR(body.shape.half_extents.x, 0.63, 1e-12);
  EXPECT_NEAR(body.shape.half_extents.z, 0.18, 1e-12);
  scene.bodies.push_back(body);
  add_plane(scene);
  World world = reference_world(scene);
  for (int k = 0; k < 50; ++k) world.step();
  EXPECT_NEAR(world.states().position[0].z, 0.18, 1e-6);
}

}  // namespace
}  // namespace scree::physics
