// Boxes on boxes: a stack that stands, a pile on an incline, and a box that falls on its edge.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "host/state_hash.h"
#include "tests/physics/long_tests.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

constexpr double kEdge = 0.1;
const Vec3d kHalf{kEdge / 2, kEdge / 2, kEdge / 2};

/// Cubes of 1 kg that stand on each other; body k is the k-th from below, the last one the floor.
Scene cube_stack(int count, double friction, Model model, double h = 1e-2) {
  Scene scene = empty_scene(h, friction, model);
  for (int k = 0; k < count; ++k) add_box(scene, {0, 0, kEdge * (k + 0.5)}, kHalf, 1);
  add_plane(scene);
  return scene;
}

class BoxStack : public ::testing::TestWithParam<std::tuple<Model, Precision>> {
 protected:
  Model model() const { return std::get<0>(GetParam()); }
  Precision precision() const { return std::get<1>(GetParam()); }
  bool in_float() const { return precision() == Precision::single_precision; }
  /// What a float solve reaches is a few roundings of the speed that gravity gives in a step.
  void set_residual(Scene& scene) const { solve_to(scene, in_float() ? 1e-6 : 1e-10); }
  World world(const Scene& scene) const { return World(scene, cpu_options(1, precision())); }
};
INSTANTIATE_TEST_SUITE_P(
    Models, BoxStack,
    ::testing::Combine(::testing::Values(Model::convex, Model::exact),
                       ::testing::Values(Precision::single_precision, Precision::double_precision)),
    [](const auto& info) {
      const bool is_float = std::get<1>(info.param) == Precision::single_precision;
      return std::string(name_of(std::get<0>(info.param))) + (is_float ? "_float" : "_double");
    });

TEST_P(BoxStack, A60_TenCubesStand) {
  constexpr int n = 10;
  Scene scene = cube_stack(n, 0.5, model());
  set_residual(scene);
  World w = world(scene);
  double early = 0, late = 0, deepest = 0;
  int unsolved = 0;
  for (int k = 0; k < 1000; ++k) {
    const StepReport report = w.step();
    unsolved += !report.converged;
    (k < 500 ? early : late) = std::max(k < 500 ? early : late, report.kinetic_energy);
    deepest = std::max(deepest, report.max_penetration);
    ASSERT_EQ(report.contact_count, 4 * n) << "step " << k;
  }
  const BodyStates s = w.states();
  const double drift = norm(s.position[n - 1] - Vec3d{0, 0, kEdge * (n - 0.5)});
  EXPECT_EQ(unsolved, 0);
  EXPECT_LT(drift, 1e-4);
  EXPECT_LT(deepest, 1e-4);
  EXPECT_LE(late, std::max(early, in_float() ? 1e-8 : 1e-16)) << "kinetic energy grows";
  // The contacts under each cube carry it and all above it.
  const double h = scene.stepping.time_step;
  for (int k = 0; k < n; ++k) {
    const int below = k == 0 ? n : k - 1;
    double sum = 0;
    for (const ContactRecord& c : w.contacts()) {
      const bool is_here =
          (c.body_a == k && c.body_b == below) || (c.body_a == below && c.body_b == k);
      if (is_here) sum += dot(c.impulse, c.normal);
    }
    const double expected = (n - k) * kGravity * h;
    EXPECT_NEAR(sum, expected, (in_float() ? 1e-3 : 1e-4) * expected) << "interface " << k;
  }
}

TEST(BoxStack, A60_AHundredCubesStand) {
  if (!runs_long_tests()) GTEST_SKIP() << kLongTest;
  constexpr int n = 100;
  Scene scene = cube_stack(n, 0.5, Model::convex);
  solve_to(scene, 1e-8);
  World w(scene, cpu_options(2));
  double early = 0, late = 0;
  int unsolved = 0;
  for (int k = 0; k < 1000; ++k) {
    const StepReport report = w.step();
    unsolved += !report.converged;
    (k < 500 ? early : late) = std::max(k < 500 ? early : late, report.kinetic_energy);
    if (k % 100 == 99) RecordProperty("iterations_" + std::to_string(k), report.iterations);
  }
  EXPECT_EQ(unsolved, 0);
  EXPECT_LT(norm(w.states().position[n - 1] - Vec3d{0, 0, kEdge * (n - 0.5)}), 1e-4);
  // What is left at each of n joints adds up to n times the residual at the top.
  EXPECT_LE(late, std::max(early, 0.5 * n * std::pow(n * 1e-8, 2))) << "kinetic energy grows";
  const double h = scene.stepping.time_step;
  std::vector<double> sum(n);  // under cube k, the floor being body n
  for (const ContactRecord& c : w.contacts()) {
    const int upper = c.body_a == n || c.body_b == n ? 0 : std::max(c.body_a, c.body_b);
    sum[static_cast<std::size_t>(upper)] += dot(c.impulse, c.normal);
  }
  for (int k = 0; k < n; ++k) {
    const double expected = (n - k) * kGravity * h;
    EXPECT_NEAR(sum[static_cast<std::size_t>(k)], expected, 1e-4 * expected) << "interface " << k;
  }
}

/// Two cubes, one on the other, on a slope: friction of both faces against gravity along it.
Scene cubes_on_slope(double degrees, double friction, Model model) {
  Scene scene = cube_stack(2, friction, model, 1e-3);
  tilt(scene, degrees);
  return scene;
}

TEST_P(BoxStack, TwoCubesStayOnASlopeBelowTheFrictionAngle) {
  Scene scene = cubes_on_slope(26, 0.5, model());  // atan(0.5) = 26.57 degrees
  set_residual(scene);
  World w = world(scene);
  run_for(w, scene, 1);
  const BodyStates s = w.states();
  for (int k = 0; k < 2; ++k) {
    EXPECT_LT(norm(s.position[k] - scene.bodies[k].position), in_float() ? 1e-4 : 1e-6);
  }
}

TEST_P(BoxStack, TwoCubesSlideTogetherAboveTheFrictionAngle) {
  const Scene ground = cubes_on_slope(32, 0.5, model());
  Scene scene = ground;
  set_residual(scene);
  World w = world(scene);
  run_for(w, scene, 0.5);
  // Friction is the same at both faces, so both cubes have the acceleration of one.
  const double angle = radians(32);
  const double a = kGravity * (std::sin(angle) - 0.5 * std::cos(angle));
  const BodyStates s = w.states();
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(s.velocity[k].x, 0.5 * a, 0.01 * 0.5 * a) << k;
}

TEST_P(BoxStack, TheUpperCubeSlidesOffARoughLowerOne) {
  // The lower cube holds to the slope, the upper one slides on it.
  Scene scene = cubes_on_slope(30, 2, model());
  Material slippery = scene.materials[0];
  slippery.friction = 0.3;
  scene.materials.push_back(slippery);
  scene.bodies[1].material = 1;
  scene.material_pairs.push_back({0, 1, slippery});
  set_residual(scene);
  World w = world(scene);
  const double duration = 0.1, angle = radians(30);
  run_for(w, scene, duration);
  const double a = kGravity * (std::sin(angle) - 0.3 * std::cos(angle));
  const BodyStates s = w.states();
  EXPECT_NEAR(s.velocity[1].x, duration * a, 0.02 * duration * a);
  EXPECT_LT(norm(s.position[0] - scene.bodies[0].position), in_float() ? 1e-4 : 1e-5);
}

TEST_P(BoxStack, ABoxThatFallsOnItsEdgeComesToRestFlat) {
  Scene scene = empty_scene(1e-3, 0.6, model());
  add_box(scene, {0, 0, 0.05}, {0.3, 0.3, 0.05}, 20);
  const double height = 0.1 + 0.05 * std::sqrt(2.0) + 0.02;
  BodyDescription& cube = add_box(scene, {0.02, 0.01, height}, kHalf, 1);
  cube.orientation = exp_map(Vec3d{0, radians(40), 0});
  add_plane(scene);
  set_residual(scene);
  World w = world(scene);
  const double start = kGravity * (height + 20 * 0.05);
  double deepest = 0;
  for (int k = 0; k < 1500; ++k) {
    const StepReport report = w.step();
    deepest = std::max(deepest, report.max_penetration);
    const BodyStates s = w.states();
    const double energy =
        report.kinetic_energy + kGravity * (s.position[1].z + 20 * s.position[0].z);
    ASSERT_LT(energy, start * (1 + 1e-3)) << "step " << k;
  }
  const BodyStates s = w.states();
  EXPECT_NEAR(s.position[1].z, 0.15, 1e-4);
  EXPECT_LT(norm(s.velocity[1]), 1e-4);
  EXPECT_LT(deepest, 1e-3);
  const Vec3d up = rotate_back(s.orientation[1], Vec3d{0, 0, 1});
  const double most = std::max({std::abs(up.x), std::abs(up.y), std::abs(up.z)});
  EXPECT_GT(most, 1 - 1e-6) << "a face lies on the other box";
}

TEST_P(BoxStack, AFixedBoxHoldsAStackToo) {
  Scene scene = cube_stack(3, 0.5, model());
  scene.bodies.pop_back();
  add_wall_box(scene, {0.1, 0, -0.1}, {0.3, 0.3, 0.1});
  set_residual(scene);
  World w = world(scene);
  for (int k = 0; k < 200; ++k) EXPECT_EQ(w.step().contact_count, 12);
  const BodyStates s = w.states();
  EXPECT_LT(norm(s.position[2] - scene.bodies[2].position), 1e-5);
}

// A light cube that carries one of up to a thousand times its mass; in double, as the user guide says of such ratios.
TEST(BoxStack, A61_ALightCubeCarriesAHeavyOne) {
  for (const Model model : {Model::convex, Model::exact}) {
    for (const double heavy : {10.0, 100.0, 1000.0}) {
      SCOPED_TRACE(std::string(name_of(model)) + " " + std::to_string(heavy));
      Scene scene = empty_scene(1e-2, 0.5, model);
      solve_to(scene, 1e-10);
      add_box(scene, {0, 0, 0.5 * kEdge}, kHalf, 1);
      add_box(scene, {0, 0, 1.5 * kEdge}, kHalf, heavy);
      add_plane(scene);
      World w = reference_world(scene);
      double deepest = 0;
      for (int k = 0; k < 300; ++k) {
        const StepReport report = w.step();
        ASSERT_TRUE(report.converged) << "step " << k;
        deepest = std::max(deepest, report.max_penetration);
      }
      EXPECT_LT(deepest, 1e-4);
      EXPECT_LT(norm(w.states().position[1] - Vec3d{0, 0, 1.5 * kEdge}), 1e-4);
      const double impulse = kGravity * scene.stepping.time_step;
      EXPECT_NEAR(normal_impulse(w, 1), heavy * impulse, 1e-4 * heavy * impulse);
      EXPECT_NEAR(normal_impulse(w, 2), (heavy + 1) * impulse, 1e-4 * (heavy + 1) * impulse);
    }
  }
}

TEST(BoxStack, ContactsAreTheSameForAnyNumberOfThreads) {
  Scene scene = empty_scene(1e-3, 0.5);
  solve_to(scene, 1e-6);
  for (int k = 0; k < 27; ++k) {
    const Vec3d site{0.13 * (k % 3), 0.13 * (k / 3 % 3), 0.06 + 0.13 * (k / 9)};
    BodyDescription& cube = add_box(scene, site, kHalf, 1);
    cube.orientation = exp_map(Vec3d{0.1 * k, 0.05 * k, 0.2 * k});
    cube.velocity = {0, 0, -0.5};
  }
  add_plane(scene);
  World one(scene, cpu_options(1)), two(scene, cpu_options(2));
  int contacts = 0;
  for (int k = 0; k < 250; ++k) {
    contacts = one.step().contact_count;
    two.step();
  }
  EXPECT_GT(contacts, 40);
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
}

}  // namespace
}  // namespace scree::physics
