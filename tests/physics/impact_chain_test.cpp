// Several contacts at once: cradles, chains of unequal masses, and the rod of Painleve.

#include <gtest/gtest.h>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// Frictionless balls of radius 0.5 m in a row along x, `gap` apart.
Scene row_of_balls(const std::vector<double>& masses, const std::vector<double>& speeds, double e,
                   double gap, double h) {
  Scene scene = empty_scene(h, 0);
  scene.gravity = {};
  scene.materials[0].restitution = e;
  solve_to(scene, 1e-12);
  scene.stepping.envelope = 1e-8;
  for (std::size_t i = 0; i < masses.size(); ++i)
    add_sphere(scene, {static_cast<double>(i) * (1 + gap), 0, 0}, 0.5, masses[i]).velocity = {
        speeds[i], 0, 0};
  return scene;
}

void expect_speeds(World& world, const std::vector<double>& expected, double tolerance) {
  const BodyStates s = world.states();
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(s.velocity[i].x, expected[i], tolerance) << "ball " << i + 1;
}

/// Velocities after the one step in which touching balls collide.
void expect_after_impact(const std::vector<double>& masses, const std::vector<double>& speeds,
                         double e, const std::vector<double>& expected) {
  World world = reference_world(row_of_balls(masses, speeds, e, 0, 1e-3));
  EXPECT_TRUE(world.step().converged);
  expect_speeds(world, expected, 1e-8);
}

TEST(ImpactChain, A40_CradleWithSimultaneousContacts) {
  for (const int n : {3, 5}) {
    std::vector<double> masses(n, 1), speeds(n, 0), expected(n, 2.0 / n);
    speeds[0] = 1;
    expected[0] = -1 + 2.0 / n;
    World world = reference_world(row_of_balls(masses, speeds, 1, 0, 1e-3));
    const StepReport report = world.step();
    EXPECT_TRUE(report.converged);
    expect_speeds(world, expected, 1e-8);
    EXPECT_NEAR(report.kinetic_energy, 0.5, 1e-8);
    for (const ContactRecord& c : world.contacts())
      EXPECT_NEAR(dot(c.impulse, c.normal), 2.0 * (n - 1 - std::min(c.body_a, c.body_b)) / n, 1e-8);
  }
}

TEST(ImpactChain, A41_InelasticCradle) {
  expect_after_impact({1, 1, 1}, {1, 0, 0}, 0.5, {0, 0.5, 0.5});
  const double third = 1.0 / 3;
  expect_after_impact({1, 1, 1}, {1, 0, 0}, 0, {third, third, third});
}

TEST(ImpactChain, A42_TwoBallsHitThree) {
  expect_after_impact({1, 1, 1, 1, 1}, {1, 1, 0, 0, 0}, 1, {-0.2, -0.2, 0.8, 0.8, 0.8});
}

TEST(ImpactChain, A43_SmallGapsMakeImpactsSequential) {
  // A step shorter than the time to cross a gap resolves the impacts one after the other.
  for (const int hitting : {1, 2}) {
    std::vector<double> speeds(5, 0), expected(5, 0);
    for (int i = 0; i < hitting; ++i) speeds[i] = expected[4 - i] = 1;
    World world = reference_world(row_of_balls({1, 1, 1, 1, 1}, speeds, 1, 1e-6, 2.3e-7));
    for (int k = 0; k < 80; ++k) EXPECT_TRUE(world.step().converged);
    expect_speeds(world, expected, 1e-8);
  }
}

// The same in one step that is much longer than the times between the impacts.
TEST(ImpactChain, A43_ImpactsAreSequentialWithinAStep) {
  for (const int hitting : {1, 2}) {
    std::vector<double> speeds(5, 0), expected(5, 0);
    for (int i = 0; i < hitting; ++i) speeds[i] = expected[4 - i] = 1;
    World world = reference_world(row_of_balls({1, 1, 1, 1, 1}, speeds, 1, 1e-3, 0.05));
    for (int k = 0; k < 2; ++k) EXPECT_TRUE(world.step().converged);
    expect_speeds(world, expected, 1e-8);
  }
}

TEST(ImpactChain, A44_HeavyLightHeavy) {
  World world = reference_world(row_of_balls({2, 1, 3}, {1, 0, -0.5}, 0.7, 0, 1e-3));
  EXPECT_TRUE(world.step().converged);
  expect_speeds(world, {-0.558333, 0.141667, 0.491667}, 1e-6);
  for (const ContactRecord& c : world.contacts())
    EXPECT_NEAR(dot(c.impulse, c.normal), std::min(c.body_a, c.body_b) == 0 ? 3.116667 : 2.975,
                1e-6);
}

/// Normal and tangential impulse on a rod that touches the floor with its tip,
/// tan(theta) = 2; W_nn = 1.6, W_nt = -1.2, W_tt = 3.4. The rod is a box without thickness to speak
/// of, which moves in the x-z plane.
struct TipImpulse {
  double n = 0, t = 0;
};
TipImpulse rod_impulse(double slip, double gravity, double mu, Model model) {
  constexpr double kThin = 1e-12;
  Scene scene = empty_scene(1e-3, mu, model);
  scene.gravity = {0, 0, -gravity};
  solve_to(scene, 1e-8);  // gaps of the vertices of the tip differ by 1e-12 m
  scene.stepping.envelope = 1e-3;
  add_plane(scene);
  const double s = 1 / std::sqrt(5.0), c = 2 / std::sqrt(5.0);
  BodyDescription& rod = add_box(scene, {0, 0, c}, {1, kThin, kThin}, 1);
  rod.inertia = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  rod.locks = lock_y | lock_rx | lock_rz;
  // Turned about y so that the -x end points to (-s, -c).
  rod.orientation = exp_map(Vec3d{0, -std::atan2(c, s), 0});
  rod.velocity = {slip, 0, 0};
  World world = reference_world(scene);
  EXPECT_TRUE(world.step().converged);
  TipImpulse p;
  for (const ContactRecord& contact : world.contacts()) {
    const double side = contact.body_b == 1 ? 1 : -1;
    p.n += side * contact.impulse.z;
    p.t += side * contact.impulse.x;
  }
  return p;
}

TEST(ImpactChain, A45_PainleveRodWedgesWithoutCollision) {
  // Without gravity Coulomb's law also allows no impulse at all, so only the convex
  // answer is unique.
  const TipImpulse weightless = rod_impulse(-1, 0, 1.6, Model::convex);
  EXPECT_NEAR(weightless.n, 0.3, 1e-6);
  EXPECT_NEAR(weightless.t, 0.4, 1e-6);
  for (const Model model : {Model::convex, Model::exact}) {
    const TipImpulse heavy = rod_impulse(-1, kGravity, 1.6, model);
    EXPECT_NEAR(heavy.n, 0.3083385, 1e-6) << name_of(model);
    EXPECT_NEAR(heavy.t, 0.402943, 1e-6) << name_of(model);
  }
}

TEST(ImpactChain, A46_PainleveRodSlidingTheOtherWay) {
  const TipImpulse convex = rod_impulse(1, kGravity, 1.6, Model::convex);
  EXPECT_NEAR(convex.n, 0.1138158, 1e-6);
  EXPECT_NEAR(convex.t, -0.1821052, 1e-6);
  const TipImpulse exact = rod_impulse(1, kGravity, 1.6, Model::exact);
  EXPECT_NEAR(exact.n, 0.00278693, 1e-6);
  EXPECT_NEAR(exact.t, -0.00445909, 1e-6);
}

}  // namespace
}  // namespace scree::physics
