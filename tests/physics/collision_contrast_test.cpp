// What other methods do with the ball of B01: both contrasts of the collision integrator.

#include <gtest/gtest.h>

#include "tests/physics/collision_systems.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

constexpr double kContrastStep = 0.01;

// Completing the step and turning the velocity at the clamped end loses or gains energy at every impact.
TEST(CollisionContrast, B02_ClampedEndPointsDoNotKeepTheEnergy) {
  const int steps = 1000000;
  double q = 1, v = 0, largest = 0;
  for (int i = 0; i < steps; ++i) {
    v -= 0.5 * kContrastStep * kWeight;
    q += kContrastStep * v;
    v -= 0.5 * kContrastStep * kWeight;
    if (q < 0) {
      q = 0;
      v = -v;
    }
    largest = std::max(largest, std::abs((0.5 * v * v + kWeight * q) / kWeight - 1));
  }
  report("largest", largest);
  EXPECT_GT(largest, 0.1);
  CollisionIntegrator ball(ball_on_floor(), {.step = kContrastStep}, {1}, {0});
  EXPECT_LT(run(ball, steps).largest_change, largest / 50);
}

// Time steps of a World with e = 1 keep the energy, with the mean of the velocities before and after a node, and turn the ball up
// to h |v| off the floor; the collision integrator turns it on the floor.
TEST(CollisionContrast, B03_TimeStepsTurnTheBallOffTheFloor) {
  const double radius = 0.1, steps = 10000;
  Scene scene = empty_scene(kContrastStep, 0);
  scene.materials[0].restitution = 1;
  add_plane(scene);
  add_sphere(scene, {0, 0, radius + 1}, radius, 1);
  World world = reference_world(scene);
  double start = 0, largest = 0, off = 0, gap = 1, before = 0, fastest = 0;
  for (int i = 0; i < steps; ++i) {
    world.step();
    const BodyStates s = world.states();
    const double v = s.velocity[1].z, mean = v - 0.5 * kContrastStep * kGravity;
    if (v > before) off = std::max(off, std::abs(gap));
    gap = s.position[1].z - radius;
    before = v;
    fastest = std::max(fastest, std::abs(v));
    const double energy = 0.5 * mean * mean + kGravity * gap;
    if (i == 0) start = energy;
    largest = std::max(largest, std::abs(energy / start - 1));
  }
  report("largest", largest);
  report("turned_off", off);
  EXPECT_LE(largest, 1e-10);
  EXPECT_GT(off, 0.25 * kContrastStep * fastest);
  EXPECT_LE(off, kContrastStep * fastest);

  CollisionIntegrator ball(ball_on_floor(), {.step = kContrastStep}, {1}, {0});
  for (int i = 0; i < steps; ++i) {
    ball.step();
    for (const Impact& impact : ball.impacts()) EXPECT_LE(std::abs(impact.position[0]), 1e-14);
  }
}

}  // namespace
}  // namespace scree::physics
