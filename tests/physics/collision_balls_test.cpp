// The collision integrator on balls that hit each other: coordinates of several bodies are one system.

#include <gtest/gtest.h>

#include <random>

#include "tests/physics/collision_systems.h"

namespace scree::physics {
namespace {

/// Balls of diameter 1 in `dimension` coordinates each.
MechanicalSystem balls(const std::vector<double>& masses, int dimension) {
  const int count = static_cast<int>(masses.size()), n = count * dimension;
  MechanicalSystem system = unit_masses(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    system.mass[static_cast<std::size_t>(i * n + i)] =
        masses[static_cast<std::size_t>(i / dimension)];
  for (int b = 0; b < count; ++b)
    for (int a = 0; a < b; ++a)
      system.walls.push_back(ball_pair_wall("balls", {.coordinate_count = n,
                                                      .first_a = a * dimension,
                                                      .first_b = b * dimension,
                                                      .dimension = dimension,
                                                      .distance = 1}));
  return system;
}

void expect_velocity(const CollisionIntegrator& integrator, const std::vector<double>& expected) {
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(integrator.velocity()[i], expected[i], 1e-12) << i;
}

// An oblique impact exchanges the velocity along the line of the centers, for any masses.
TEST(CollisionBalls, TwoInSpace) {
  const double m = 3, along = 0.8, across = 0.6;  // the line of centers is turned by acos(0.8)
  CollisionIntegrator pair(balls({1, m}, 3), {.step = 2}, {-along - 1, -across, 0, 0, 0, 0},
                           {1, 0, 0, 0, 0, 0});
  pair.step();
  ASSERT_EQ(pair.impacts().size(), 1);
  EXPECT_NEAR(pair.impacts().front().time, 1, 1e-12);
  const double change = 2 * along / (1 + 1 / m);  // impulse along (0.8, 0.6)
  expect_velocity(
      pair, {1 - change * along, -change * across, 0, change * along / m, change * across / m, 0});
}

// One ball comes between two that touch: all three contacts at once, and it goes back with a fifth of its speed.
TEST(CollisionBalls, OneOnTwoThatTouch) {
  const double x = std::sqrt(0.75);
  CollisionIntegrator three(balls({1, 1, 1}, 2), {.step = 1}, {-x - 0.5, 0, 0, 0.5, 0, -0.5},
                            {1, 0, 0, 0, 0, 0});
  three.step();
  ASSERT_EQ(three.impacts().size(), 1);
  EXPECT_EQ(three.impacts().front().parts.size(), 3);
  expect_velocity(three, {-0.2, 0, 0.6, 0.6 / std::sqrt(3), 0.6, -0.6 / std::sqrt(3)});
}

// A cradle without gaps shares the impulse at once; with gaps it hands it on, all within one step.
TEST(CollisionBalls, CradleWithAndWithoutGaps) {
  CollisionIntegrator touching(balls({1, 1, 1}, 1), {.step = 1}, {-0.5, 1, 2}, {1, 0, 0});
  touching.step();
  expect_velocity(touching, {-1.0 / 3, 2.0 / 3, 2.0 / 3});
  CollisionIntegrator apart(balls({1, 1, 1}, 1), {.step = 1}, {-0.5, 1, 2.01}, {1, 0, 0});
  apart.step();
  EXPECT_EQ(apart.impacts().size(), 2);
  expect_velocity(apart, {0, 0, 1});
}

// Five balls in a box, many hits in a step: energy, and momentum between balls.
TEST(CollisionBalls, GasInABox) {
  const std::vector<double> masses = {1, 2, 0.5, 1, 3};
  MechanicalSystem system = balls(masses, 2);
  for (std::size_t i = 0; i < 10; ++i)
    for (const double sign : {1.0, -1.0}) {
      std::vector<double> side(10, 0);
      side[i] = sign;
      system.walls.push_back(half_space_wall("side", {side, -2.5}));
    }
  const std::size_t pairs = system.walls.size() - 20;
  CollisionIntegrator gas(std::move(system), {.step = 0.1}, {-2, -2, 0, 0, 2, 2, -2, 2, 2, -2},
                          {3, 1, -2, 4, 1, -5, 2, 2, -1, -2});
  const double energy = gas.energy();
  std::int64_t among_balls = 0;
  for (int i = 0; i < 5000; ++i) {
    gas.step();
    ASSERT_NEAR(gas.energy() / energy, 1, 1e-11);
    for (const Impact& impact : gas.impacts()) {
      if (static_cast<std::size_t>(impact.parts.front().wall) >= pairs) continue;
      ++among_balls;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        double change = 0;
        for (std::size_t k = axis; k < 10; k += 2) change += impact.after[k] - impact.before[k];
        ASSERT_NEAR(change, 0, 1e-12);
      }
    }
  }
  EXPECT_GT(among_balls, 1000);
  EXPECT_GE(gas.totals().smallest_gap, -1e-12);
  EXPECT_LE(gas.totals().largest_closest_point_error, 1e-12);
}

}  // namespace
}  // namespace scree::physics
