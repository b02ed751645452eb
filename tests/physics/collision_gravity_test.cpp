// The collision integrator under gravity: a point in a bowl, and a rod on a floor. Both are chaotic or sheared: statistics and
// bounds are compared, not trajectories.

#include <gtest/gtest.h>

#include <functional>

#include "tests/physics/collision_systems.h"

namespace scree::physics {
namespace {

CollisionIntegrator in_bowl(double h, double x = 0.35) {
  return {point_in_bowl(), {.step = h}, {x, 1}, {0.4, 0}};
}

CollisionIntegrator fallen_rod(double h, double height = 1.5) {
  return {rod_on_floor(), {.step = h}, {0, height, 0.3}, {0.2, 0, 0.1}};
}

/// Impacts of several runs.
struct Counts {
  double impacts = 0, grazing = 0;
};

/// Largest change of energy over a number of steps, whose bounds it checks.
double energy_error(CollisionIntegrator integrator, double h, int steps, Counts& counts) {
  const double largest = run(integrator, steps).largest_change;
  EXPECT_LE(largest, 1.5 * random_walk_bound(integrator, h)) << h;
  EXPECT_GE(integrator.totals().smallest_gap, -1e-12);
  EXPECT_LE(integrator.totals().largest_closest_point_error, 1e-12);
  counts.impacts += static_cast<double>(integrator.totals().impacts);
  counts.grazing += static_cast<double>(integrator.totals().grazing_impacts);
  return largest;
}

/// Means of five starts with steps h, h/2 and h/4 fall by at least two from each to the next.
void expect_errors_to_fall(const std::function<double(double h, int start, Counts&)>& error) {
  double coarse = 0;
  for (const double h : {0.01, 0.005, 0.0025}) {
    double mean = 0;
    Counts counts;
    for (int start = 0; start < 5; ++start) mean += error(h, start, counts) / 5;
    EXPECT_LT(counts.grazing, 1e-3 * counts.impacts) << h;
    report("mean_" + std::to_string(std::lround(h * 10000)) + "e-4", mean);
    if (coarse > 0) {
      EXPECT_GE(coarse / mean, 2) << h;
    }
    coarse = mean;
  }
}

TEST(CollisionBowl, B04_EnergyOfFiveStarts) {
  expect_errors_to_fall([](double h, int start, Counts& counts) {
    return energy_error(in_bowl(h, 0.35 + 0.05 * start), h, 50000, counts);
  });
}

TEST(CollisionBowl, B04_EnergyOverAMillionSteps) {
  Counts counts;
  for (const double h : {0.01, 0.005})
    report("largest_" + std::to_string(std::lround(h * 10000)) + "e-4",
           energy_error(in_bowl(h), h, 1000000, counts));
  EXPECT_LT(counts.grazing, 1e-3 * counts.impacts);
}

// The bowl with this focus has a second invariant, which the integrator keeps less well, and to the same order.
TEST(CollisionBowl, B04_SecondInvariant) {
  const auto error = [](double h) {
    CollisionIntegrator point = in_bowl(h);
    const auto invariant = [&] {
      const double x = point.position()[0], y = point.position()[1];
      const double u = point.momentum()[0], v = point.momentum()[1];
      return u * (x * v - y * u) + kWeight * x * x / 2;
    };
    const double start = invariant();
    double largest = 0;
    for (int i = 0; i < 50000; ++i) {
      point.step();
      largest = std::max(largest, std::abs(invariant() / start - 1));
    }
    return largest;
  };
  const double coarse = error(0.01), fine = error(0.005);
  report("largest_100e-4", coarse);
  report("largest_50e-4", fine);
  EXPECT_LE(coarse, 3 * 3.0e-2);
  EXPECT_LE(fine, 3 * 5.8e-3);
}

// Places after some impacts, against steps that are 16 times as fine, over many starts.
TEST(CollisionBowl, ErrorFallsWithTheSquareOfTheStep) {
  const auto end = [](double h, int start) {
    CollisionIntegrator point = in_bowl(h, 0.3 + 0.004 * start);
    for (int i = 0; i < std::lround(2.56 / h); ++i) point.step();
    return point.position();
  };
  const auto error = [&](double h) {
    double sum = 0;
    for (int start = 0; start < 100; ++start) {
      const auto coarse = end(h, start), fine = end(h / 16, start);
      sum += std::hypot(coarse[0] - fine[0], coarse[1] - fine[1]);
    }
    return sum / 100;
  };
  double coarse = error(0.02);
  report("error_20e-3", coarse);
  for (const double h : {0.01, 0.005}) {
    const double fine = error(h);
    report("error_" + std::to_string(std::lround(h * 1000)) + "e-3", fine);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3) << h;
    coarse = fine;
  }
}

TEST(CollisionRod, B08_EnergyOfFiveStarts) {
  expect_errors_to_fall([](double h, int start, Counts& counts) {
    return energy_error(fallen_rod(h, 1.5 + 0.02 * start), h, 20000, counts);
  });
}

TEST(CollisionRod, B08_EnergyAndMomentumOverAMillionSteps) {
  for (const double h : {0.01, 0.005, 0.0025}) {
    CollisionIntegrator rod = fallen_rod(h);
    double momentum_error = 0;
    const double start = rod.energy();
    double largest = 0;
    for (int i = 0; i < 1000000; ++i) {
      rod.step();
      largest = std::max(largest, std::abs(rod.energy() / start - 1));
      momentum_error = std::max(momentum_error, std::abs(rod.momenta()[0] - 0.2));
    }
    const std::string name = "_" + std::to_string(std::lround(h * 10000)) + "e-4";
    report("largest" + name, largest);
    report("momentum_error" + name, momentum_error);
    report("grazing" + name, static_cast<double>(rod.totals().grazing_impacts));
    report("impacts" + name, static_cast<double>(rod.totals().impacts));
    EXPECT_LE(largest, 1.5 * random_walk_bound(rod, h));
    EXPECT_LE(momentum_error, 1e-13);
    EXPECT_LT(static_cast<double>(rod.totals().grazing_impacts),
              1e-3 * static_cast<double>(rod.totals().impacts));
    EXPECT_GE(rod.totals().smallest_gap, -1e-12);
  }
}

// An elastic impact keeps the discrete energy of the ways to it and from it, and gravity makes the jump of nodes the same for all
// walls and coordinates.
TEST(CollisionRod, JumpOfAnImpact) {
  const double h = 0.01;
  CollisionIntegrator rod = fallen_rod(h);
  for (int i = 0; i < 50000; ++i) {
    const double before = rod.energy(), start = rod.time();
    rod.step();
    double jump = 0;
    for (const Impact& impact : rod.impacts())
      if (!impact.grazing) {
        EXPECT_NEAR(impact.energy_after, impact.energy, 1e-12);
      }
    if (rod.impacts().size() > 1) continue;
    if (!rod.impacts().empty()) {
      if (rod.impacts().front().grazing) continue;
      const double alpha = (rod.impacts().front().time - start) / h;
      jump = kWeight * kWeight * h * h * (1 - 2 * alpha) / 8;
    }
    ASSERT_NEAR(rod.energy() - before, jump, 1e-10);
  }
}

}  // namespace
}  // namespace scree::physics
