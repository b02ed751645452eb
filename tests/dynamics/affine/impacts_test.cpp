// Impacts under bdf2: nothing leaves faster than it came, wherever in a step it hits, and momentum stays.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dynamics/affine/affine_card.h"
#include "kernels/affine/inertial_target.h"
#include "tests/dynamics/affine_scenes.h"

namespace scree::affine {
namespace {

using namespace test;
using physics::add_box;
using physics::kGravity;

constexpr double kTimeStep = 0.01;
constexpr double kSecondOrder = static_cast<double>(StepRule::bdf2);
constexpr int kImpactPlaces = 10;  ///< of an impact in a step that are tried

Scene scene_without_gravity() {
  Scene scene = affine_scene(kTimeStep, 0, kSecondOrder);
  scene.gravity = {};
  scene.dynamics.parameters["reach"] = 1e-4;
  scene.dynamics.parameters["tolerance"] = 1e-6;
  return scene;
}

TEST(AffineImpacts, ABodyIsNotThrownBackByAWallWhereverInTheStepItHits) {
  for (int place = 0; place < kImpactPlaces; ++place) {
    SCOPED_TRACE(place);
    Scene scene = scene_without_gravity();
    const double way = (5 + place / double{kImpactPlaces}) * kTimeStep;  // to the wall, at 1 m/s
    add_box(scene, {}, {0.05, 0.05, 0.05}, 1).velocity = {1, 0, 0};
    physics::add_wall_box(scene, {0.1 + 0.05 + way, 0, 0}, {0.1, 1, 1});
    World world(scene, cpu_options());
    double least = 1, most_energy = 0;
    for (int k = 0; k < 20; ++k) {
      const StepReport report = world.step();
      most_energy = std::max(most_energy, report.kinetic_energy);
      least = std::min(least, world.states().velocity[0].x);
    }
    EXPECT_LE(most_energy, 0.5 + 1e-9);
    EXPECT_GT(least, -0.06);
    EXPECT_NEAR(world.states().velocity[0].x, 0, 0.06);
  }
}

TEST(AffineImpacts, ABodyThatFallsComesToRestOnTheFloor) {
  for (int place = 0; place < kImpactPlaces; ++place) {
    SCOPED_TRACE(place);
    Scene scene = affine_scene(kTimeStep, 0.3, kSecondOrder);
    const double height = 0.3 + 0.02 * place / kImpactPlaces;
    add_box(scene, {0, 0, 0.05 + height}, {0.05, 0.05, 0.05}, 1);
    physics::add_wall_box(scene, {0, 0, -0.1}, {1, 1, 0.1});
    World world(scene, cpu_options());
    const double speed = std::sqrt(2 * kGravity * height);
    double most = 0;
    for (int k = 0; k < 60; ++k) {
      world.step();
      most = std::max(most, world.states().velocity[0].z);
    }
    EXPECT_LT(most, 0.06 * speed);
    EXPECT_NEAR(world.states().velocity[0].z, 0, 0.02 * speed);
  }
}

TEST(AffineImpacts, BodiesThatMeetKeepTheirMomentumAndGoOnTogether) {
  for (const double mass : {0.1, 1.0, 100.0})
    for (int place = 0; place < kImpactPlaces; ++place) {
      SCOPED_TRACE(testing::Message() << mass << " kg, " << place);
      Scene scene = scene_without_gravity();
      const double way = (3 + place / double{kImpactPlaces}) * kTimeStep;
      add_box(scene, {0, 0.5, 0.2}, {0.05, 0.05, 0.05}, 1).velocity = {1, 0, 0};
      add_box(scene, {0.1 + way, 0.5, 0.2}, {0.05, 0.05, 0.05}, mass);
      World world(scene, cpu_options());
      const double together = 1 / (1 + mass);
      for (int k = 0; k < 20; ++k) {
        const StepReport report = world.step();
        EXPECT_NEAR(report.own[momentum_x], 1, 1e-9);
        EXPECT_LE(report.kinetic_energy, 0.5 + 1e-9);
      }
      EXPECT_NEAR(world.states().velocity[0].x, together, 0.06);
      EXPECT_NEAR(world.states().velocity[1].x, together, 0.06);
    }
}

/// What one body of a chain on hinges meets, all of it feels.
TEST(AffineImpacts, JointedBodiesShareTheMomentumOfAnImpact) {
  Scene scene = scene_without_gravity();
  add_box(scene, {-0.1, 0, 0}, {0.08, 0.03, 0.03}, 1).velocity = {1, 0, 0};
  add_box(scene, {0.1, 0, 0}, {0.08, 0.03, 0.03}, 1).velocity = {1, 0, 0};
  add_box(scene, {0.25, 0, 0}, {0.03, 0.03, 0.03}, 2);
  Joint hinge;
  hinge.bodies = {0, 1};
  hinge.axis = {0, 1, 0};
  scene.joints = {hinge};
  World world(scene, cpu_options());
  for (int k = 0; k < 30; ++k) {
    const StepReport report = world.step();
    EXPECT_NEAR(report.own[momentum_x], 2, 1e-8);
    EXPECT_LE(report.kinetic_energy, 1 + 1e-8);
  }
  for (const Vec3d& velocity : world.states().velocity) EXPECT_NEAR(velocity.x, 0.5, 0.06);
}

/// Bodies of many masses that meet in turn, some in every step: nothing of their momentum is lost between those that start anew and those that go on.
TEST(AffineImpacts, ACrowdKeepsItsMomentum) {
  Scene scene = affine_scene(kTimeStep, 0, kSecondOrder);
  scene.gravity = {};
  for (int k = 0; k < 27; ++k) {
    const int x = k / 9 - 1, y = k / 3 % 3 - 1, z = k % 3 - 1;
    const Vec3d place{0.16 * x, 0.16 * y, 0.16 * z};
    BodyDescription& box =
        add_box(scene, place, {0.04, 0.03, 0.05}, std::pow(10.0, (7 * k % 27) / 13.0 - 1));
    box.velocity = (k == 13 ? 0.0 : -3 / norm(place)) * place + Vec3d{0.1 * (k % 5), 0, 0.2};
    box.angular_velocity = {1.0 * (k % 3), 2.0 - k % 4, 1};
    box.orientation = exp_map(Vec3d{0.3 * (k % 7), 0.2 * (k % 5), 0.1 * k});
  }
  double most = 0;
  for (const BodyDescription& box : scene.bodies) most += 3 * box.mass;
  World world(scene, cpu_options());
  const StepReport first = world.step();
  const double energy = first.kinetic_energy;
  StepReport last;
  for (int k = 0; k < 60; ++k) {
    last = world.step();
    ASSERT_TRUE(last.converged) << last.step;
  }
  EXPECT_LT(last.kinetic_energy, 0.9 * energy);  // they have met
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(last.own[momentum_x + k], first.own[momentum_x + k], 1e-6 * most);
}

TEST(AffineImpacts, AHingeAtItsLimitIsNotThrownBack) {
  for (int place = 0; place < kImpactPlaces; ++place) {
    SCOPED_TRACE(place);
    Scene scene = scene_without_gravity();
    add_box(scene, {0.1, 0, 0}, {0.1, 0.02, 0.02}, 1).angular_velocity = {0, 0, 2};
    scene.bodies.back().velocity = {0, 0.2, 0};
    Joint hinge;
    hinge.bodies = {kWorldBody, 0};
    hinge.axis = {0, 0, 1};
    hinge.limits = {-1, 0.2 + 0.02 * place / kImpactPlaces};
    scene.joints = {hinge};
    World world(scene, cpu_options());
    double least = 2;
    for (int k = 0; k < 40; ++k) {
      world.step();
      least = std::min(least, world.states().angular_velocity[0].z);
    }
    EXPECT_GT(least, -0.12);
  }
}

/// Boxes that meet head-on while both fly, and how fast they then part, over how fast they met.
double restitution_in_frame_of(const Vec3d& velocity, double place) {
  Scene scene = scene_without_gravity();
  add_box(scene, {-0.1 - (5 + place) * kTimeStep, 0, 0}, {0.05, 0.05, 0.05}, 1).velocity =
      velocity + Vec3d{1, 0, 0};
  add_box(scene, {}, {0.05, 0.05, 0.05}, 1).velocity = velocity;
  World world(scene, cpu_options());
  for (int k = 0; k < 20; ++k) world.step();
  const BodyStates states = world.states();
  return states.velocity[1].x - states.velocity[0].x;
}

TEST(AffineImpacts, DoNotDependOnTheFrame) {
  for (int place = 0; place < kImpactPlaces; ++place) {
    SCOPED_TRACE(place);
    const double share = place / double{kImpactPlaces},
                 at_rest = restitution_in_frame_of({}, share);
    EXPECT_LT(std::abs(at_rest), 0.12);
    for (const Vec3d& frame : {Vec3d{10, 0, 0}, Vec3d{0, 10, 0}, Vec3d{-3, 4, 20}})
      EXPECT_NEAR(restitution_in_frame_of(frame, share), at_rest, 1e-3);
  }
}

TEST(AffineImpacts, ASpinningDiscIsNotThrownBackByTheFloor) {
  for (const double spin : {0.0, 50.0}) {
    Scene scene = affine_scene(kTimeStep, 0, kSecondOrder);
    add_box(scene, {0, 0, 0.08}, {0.05, 0.05, 0.03}, 1).angular_velocity = {0, 0, spin};
    physics::add_wall_box(scene, {0, 0, -0.1}, {1, 1, 0.1});
    World world(scene, cpu_options());
    double most = 0;
    for (int k = 0; k < 40; ++k) {
      world.step();
      most = std::max(most, world.states().velocity[0].z);
    }
    EXPECT_LT(most, 0.12) << spin;
  }
}

/// A plate that lands while it slides and takes off again: contacts that open in a step have no friction left.
TEST(AffineImpacts, FrictionOfALandingIsBoundByItsNormalForce) {
  constexpr double kMu = 0.5, kStep = 0.005, kSpeed = 10;
  Scene scene = affine_scene(kStep, kMu, kSecondOrder);
  scene.dynamics.parameters["friction_solves"] = 2;
  physics::add_plane(scene);
  add_box(scene, {0, 0, 0.06}, {0.1, 0.1, 0.01}, 0.8).velocity = {kSpeed, 0, 0};
  World world(scene, cpu_options());
  for (int k = 1; k <= 40; ++k) {
    world.step();
    const Vec3d v = world.states().velocity[1];
    const double normal = v.z + kGravity * kStep * k;  // impulse so far, over the mass
    EXPECT_LE(kSpeed - v.x, 1.03 * kMu * normal + 1e-3) << k;
  }
}

/// What is not hit goes on as before: a ball that spins beside one that falls keeps its spin as alone.
TEST(AffineImpacts, BodiesElsewhereAreNotTouched) {
  const auto spin_beside = [](bool falls) {
    Scene scene = affine_scene(kTimeStep, 0.3, kSecondOrder);
    add_box(scene, {0, 0, 3}, {0.05, 0.06, 0.04}, 1).angular_velocity = {0, 0, 15};
    physics::add_wall_box(scene, {0, 0, -0.1}, {1, 1, 0.1});
    if (falls) add_box(scene, {0.5, 0, 0.2}, {0.05, 0.05, 0.05}, 1);
    scene.dynamics.parameters["reach"] = 1e-4;
    scene.dynamics.parameters["tolerance"] = 1e-9;
    World world(scene, cpu_options());
    for (int k = 0; k < 40; ++k) world.step();
    return world.states().angular_velocity[0].z;
  };
  EXPECT_NEAR(spin_beside(true), spin_beside(false), 1e-9);
}

}  // namespace
}  // namespace scree::affine
