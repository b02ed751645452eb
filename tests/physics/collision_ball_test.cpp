// The collision integrator on a ball above a floor: energy, its jumps, order, losses and rest.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/physics/collision_systems.h"

namespace scree::physics {
namespace {

constexpr int kMillion = 1000000;

/// A ball that is let go at 1 m. The floor is elastic and height 0.
CollisionIntegrator dropped_ball(double h, double height = 1) {
  return {ball_on_floor(), {.step = h}, {height}, {0}};
}

/// Height of a ball let go at `height` that bounces elastically.
double exact_height(double height, double time) {
  const double fall = std::sqrt(2 * height / kWeight);
  const double since_apex = std::remainder(time, 2 * fall);
  return height - 0.5 * kWeight * since_apex * since_apex;
}

struct BallCase {
  double h, largest, last;
  std::int64_t impacts;
};

class CollisionBall : public testing::TestWithParam<BallCase> {};

TEST_P(CollisionBall, B01_EnergyOverAMillionSteps) {
  const BallCase expected = GetParam();
  CollisionIntegrator ball = dropped_ball(expected.h);
  const EnergyRecord energy = run(ball, kMillion);
  report("largest", energy.largest_change);
  report("last", energy.last_change);
  report("impacts", static_cast<double>(ball.totals().impacts));
  EXPECT_LE(energy.largest_change, 3 * expected.largest);
  EXPECT_LE(energy.last_change, 3 * expected.last);
  EXPECT_LE(energy.largest_change, random_walk_bound(ball, expected.h));
  EXPECT_NEAR(static_cast<double>(ball.totals().impacts), static_cast<double>(expected.impacts), 2);
  EXPECT_EQ(ball.totals().grazing_impacts, 0);
  EXPECT_GE(ball.totals().smallest_gap, -1e-12);
}

INSTANTIATE_TEST_SUITE_P(Steps, CollisionBall,
                         testing::Values(BallCase{0.01, 1.22e-3, 1.6e-4, 11075},
                                         BallCase{0.005, 7.1e-5, 7.1e-5, 5537},
                                         BallCase{0.0025, 1.2e-5, 1.2e-5, 2768}));

// The energy of a node changes by g^2 h^2 (1 - 2 alpha) / 8 in an impact, and by nothing else.
TEST(CollisionBall, B01_JumpOfAnImpact) {
  const double h = 0.01;
  CollisionIntegrator ball = dropped_ball(h);
  int impacts = 0;
  double largest_error = 0;
  for (int i = 0; i < kMillion; ++i) {
    const double before = ball.energy(), start = ball.time();
    ball.step();
    double jump = 0;
    if (!ball.impacts().empty()) {
      ASSERT_EQ(ball.impacts().size(), 1);
      const Impact& impact = ball.impacts().front();
      const double alpha = (impact.time - start) / h;
      jump = kWeight * kWeight * h * h * (1 - 2 * alpha) / 8;
      EXPECT_NEAR(impact.energy_after, impact.energy, 1e-12);
      ++impacts;
    }
    const double error = std::abs(ball.energy() - before - jump);
    largest_error = std::max(largest_error, error);
    ASSERT_LE(error, 1e-10) << i;
  }
  report("jump_error", largest_error);
  EXPECT_GT(impacts, 10000);
}

// Error of the place after a few bounces, against the closed form, over many heights.
TEST(CollisionBall, ErrorFallsWithTheSquareOfTheStep) {
  const auto error = [](double h) {
    double sum = 0;
    for (int k = 0; k < 200; ++k) {
      const double height = 0.5 + 0.005 * k;
      CollisionIntegrator ball = dropped_ball(h, height);
      for (int i = 0; i < std::lround(4 / h); ++i) ball.step();
      sum += std::abs(ball.position()[0] - exact_height(height, 4));
    }
    return sum / 200;
  };
  double coarse = error(0.04);
  report("error_40e-3", coarse);
  for (const double h : {0.02, 0.01, 0.005}) {
    const double fine = error(h);
    report("error_" + std::to_string(std::lround(h * 1000)) + "e-3", fine);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.25) << h;
    coarse = fine;
  }
}

// Heights of bounces with restitution e fall by e^2, the first ones off by O(h^2).
TEST(CollisionBall, B10_RestitutionScalesHeights) {
  const double e = 0.9;
  const auto heights = [&](double h) {
    MechanicalSystem system = ball_on_floor();
    system.walls[0].restitution = e;
    CollisionIntegrator ball(std::move(system), {.step = h}, {1}, {0});
    std::vector<double> out;
    while (out.size() < 8) {
      ball.step();
      if (!ball.impacts().empty()) out.push_back(ball.energy() / kWeight);
    }
    return out;
  };
  for (const double h : {0.01, 0.005, 0.0025}) {
    const std::vector<double> found = heights(h);
    double largest = 0;
    for (std::size_t n = 0; n < found.size(); ++n) {
      const double bounces = static_cast<double>(n + 1);
      const double error = std::abs(found[n] - std::pow(e, 2 * bounces));
      EXPECT_LE(error, kWeight * h * h / 8 * bounces) << h << ' ' << n;
      largest = std::max(largest, error);
    }
    report("height_error_" + std::to_string(std::lround(h * 10000)) + "e-4", largest);
  }
}

// It comes to rest after the time of infinitely many bounces, and says so by name, as it was before that step.
TEST(CollisionBall, B10_RestIsRefusedByName) {
  const double e = 0.9, h = 1e-3;
  MechanicalSystem system = ball_on_floor();
  system.walls[0].restitution = e;
  CollisionIntegrator ball(std::move(system), {.step = h}, {1}, {0});
  std::string message;
  while (message.empty() && ball.time() < 20) {
    const std::vector<double> q = ball.position(), p = ball.momentum();
    const CollisionTotals totals = ball.totals();
    try {
      ball.step();
    } catch (const RestingContact& rest) {
      message = rest.what();
      EXPECT_EQ(ball.position(), q);
      EXPECT_EQ(ball.momentum(), p);
      EXPECT_EQ(ball.totals().steps, totals.steps);
      EXPECT_EQ(ball.totals().impacts, totals.impacts);
    }
  }
  EXPECT_THAT(message, testing::AllOf(testing::HasSubstr("resting contact with wall \"floor\""),
                                      testing::HasSubstr("hand-over speed")));
  // Below the speed g h / 2 what is left of the time of bounces is short.
  const double fall = std::sqrt(2 / kWeight);
  EXPECT_NEAR(ball.time(), fall * (1 + 2 * e / (1 - e)), 0.1);
  EXPECT_LT(std::abs(ball.velocity()[0]), 2 * kWeight * h);
}

TEST(CollisionBall, ABallThatLiesOnTheFloorIsRefused) {
  CollisionIntegrator ball(ball_on_floor(), {.step = 0.01}, {0}, {0});
  EXPECT_THROW(ball.step(), RestingContact);
  EXPECT_EQ(ball.time(), 0);
  CollisionIntegrator low(ball_on_floor(), {.step = 0.01, .handover_speed = 1}, {0.01}, {0});
  EXPECT_THROW(for (int i = 0; i < 10; ++i) low.step(), RestingContact);
}

// Bounces shorter than a step: at most one impact in each, and energies that the jumps of all impacts allow.
TEST(CollisionBall, BouncesShorterThanAStep) {
  const double h = 0.01, jump = kWeight * kWeight * h * h / 8;
  CollisionIntegrator ball = dropped_ball(h, 1e-5);
  for (int i = 0; i < 1000; ++i) {
    ball.step();
    EXPECT_LE(ball.impacts().size(), 1);
  }
  EXPECT_LT(ball.energy(),
            jump * (1 + 4 * std::sqrt(static_cast<double>(ball.totals().impacts) / 3)));
  EXPECT_GE(ball.totals().smallest_gap, -1e-12);
}

// A hill that falls away under a point nearly as fast as the point falls is met so slowly, and so late in the step, that the energy
// equation has no root: the point is turned at once, which keeps the energy at the impact itself, and the impact is counted.
TEST(CollisionBall, AGrazingImpactIsTurnedAtOnceAndCounted) {
  const double h = 0.01, bend = 0.45 * kWeight, time = 0.9 * h;
  MechanicalSystem system = unit_masses(2);
  add_gravity(system, 1);
  system.walls = {quadric_wall("hill", {2 * bend, 0, 0, 0}, {0, 1}, 0)};  // y >= -bend x^2
  const double height = (0.5 * kWeight - bend) * time * time;
  CollisionIntegrator point(std::move(system), {.step = h}, {0, height}, {1, 0});
  const double energy = point.energy();
  point.step();
  ASSERT_EQ(point.totals().impacts, 1);
  EXPECT_EQ(point.totals().grazing_impacts, 1);
  const Impact& impact = point.impacts().front();
  EXPECT_NEAR(impact.time, time, 1e-12);
  EXPECT_TRUE(impact.grazing);
  // Reflection in the tangent of the hill there.
  const double slope = -2 * bend * time, square = 1 + slope * slope;
  const double normal = (-slope * 1 - kWeight * time) / square;
  EXPECT_NEAR(impact.after[0], 1 + 2 * normal * slope, 1e-12);
  EXPECT_NEAR(impact.after[1], -kWeight * time - 2 * normal, 1e-12);
  EXPECT_NEAR(point.energy(), energy, 1e-12);
  EXPECT_LE(impact.closest_point_error, 1e-12);
}

// Coulomb's law for a point: the tangential velocity falls by mu (1 + e) |v_n|, or to zero.
TEST(CollisionBall, B10_FrictionIsCoulombs) {
  for (const double mu : {0.1, 0.3, 2.0}) {
    MechanicalSystem system = unit_masses(3);
    for (double& m : system.mass) m *= 2;
    system.walls = {half_space_wall("floor", {{0, 0, 1}, 0})};
    system.walls[0].restitution = 0.5;
    system.walls[0].friction = mu;
    CollisionIntegrator point(std::move(system), {.step = 1}, {0, 0, 1}, {3, -4, -2});
    point.step();
    const double left = std::max(0.0, 1 - mu * 1.5 * 2 / 5);
    const std::vector<double> v = point.velocity();
    EXPECT_NEAR(v[0], 3 * left, 1e-14);
    EXPECT_NEAR(v[1], -4 * left, 1e-14);
    EXPECT_NEAR(v[2], 1, 1e-14);
    EXPECT_TRUE(std::isnan(point.impacts().front().closest_point_error));
  }
}

}  // namespace
}  // namespace scree::physics
