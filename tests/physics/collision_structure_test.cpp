// What the collision integrator owes to its action: maps of steps with impacts are symplectic and can be reversed; and what holds in any
// system, on random ones.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>
#include <random>

#include "tests/physics/collision_systems.h"

namespace scree::physics {
namespace {

using Vec = Eigen::VectorXd;
using Mat = Eigen::MatrixXd;

std::vector<double> numbers_of(const Vec& v) { return {v.begin(), v.end()}; }

/// (q, p) after some steps from (q, p); all masses are 1.
using PhaseMap = std::function<Vec(const Vec&)>;

/// @param impacts  that there are on the way
PhaseMap map_of(const MechanicalSystem& system, double h, int steps, int impacts) {
  return [=](const Vec& start) {
    const Eigen::Index n = start.size() / 2;
    CollisionIntegrator integrator(system, {.step = h}, numbers_of(start.head(n)),
                                   numbers_of(start.tail(n)));
    for (int i = 0; i < steps; ++i) integrator.step();
    EXPECT_EQ(integrator.totals().impacts, impacts);
    EXPECT_EQ(integrator.totals().grazing_impacts, 0);
    Vec end(2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      end[i] = integrator.position()[static_cast<std::size_t>(i)];
      end[n + i] = integrator.momentum()[static_cast<std::size_t>(i)];
    }
    return end;
  };
}

/// Largest entry of J' Omega J - Omega, with the derivative J from central differences.
double symplectic_defect(const PhaseMap& map, const Vec& start) {
  const Eigen::Index size = start.size(), n = size / 2;
  const double d = 1e-5;
  Mat jacobian(size, size), omega = Mat::Zero(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    const Vec change = d * Vec::Unit(size, j);
    jacobian.col(j) = (map(start + change) - map(start - change)) / (2 * d);
  }
  omega.topRightCorner(n, n).setIdentity();
  omega.bottomLeftCorner(n, n) = -Mat::Identity(n, n);
  return (jacobian.transpose() * omega * jacobian - omega).cwiseAbs().maxCoeff();
}

/// A point in the bowl, on a spring to a place beside it.
MechanicalSystem sprung_point_in_bowl() {
  MechanicalSystem system = point_in_bowl();
  system.potential = [](std::span<const double> q) {
    return kWeight * q[1] + 1.5 * (q[0] - 1) * (q[0] - 1) + 0.3 * q[0] * q[0] * q[1] * q[1];
  };
  system.potential_gradient = [](std::span<const double> q, std::span<double> gradient) {
    gradient[0] = 3 * (q[0] - 1) + 0.6 * q[0] * q[1] * q[1];
    gradient[1] = kWeight + 0.6 * q[0] * q[0] * q[1];
  };
  return system;
}

TEST(CollisionStructure, StepsWithImpactsAreSymplectic) {
  const Vec start{{0.35, 1, 0.4, 0}};
  EXPECT_LE(symplectic_defect(map_of(point_in_bowl(), 0.02, 100, 3), start), 1e-6);
  EXPECT_LE(symplectic_defect(map_of(sprung_point_in_bowl(), 0.02, 100, 3), start), 1e-6);
  EXPECT_LE(symplectic_defect(map_of(ball_on_floor(), 0.02, 60, 1), Vec{{1, 0}}), 1e-6);
  // The check itself: a clamped step of the ball is not.
  const PhaseMap clamped = [](const Vec& start_) {
    Vec x = start_;
    for (int i = 0; i < 60; ++i) {
      x[1] -= 0.01 * kWeight;
      x[0] += 0.02 * x[1];
      x[1] -= 0.01 * kWeight;
      if (x[0] < 0) x = Vec{{0, -x[1]}};
    }
    return x;
  };
  EXPECT_GT(symplectic_defect(clamped, Vec{{1, 0}}), 0.1);
}

// Turning all momenta leads back, through impacts, several in a step included.
TEST(CollisionStructure, MotionCanBeReversed) {
  const auto go_back = [](const MechanicalSystem& system, double h, int steps,
                          std::vector<double> q, const std::vector<double>& v) {
    CollisionIntegrator there(system, {.step = h}, q, v);
    for (int i = 0; i < steps; ++i) there.step();
    EXPECT_GT(there.totals().impacts, 2);
    EXPECT_EQ(there.totals().grazing_impacts, 0);
    std::vector<double> turned = there.velocity();
    for (double& x : turned) x = -x;
    CollisionIntegrator back(system, {.step = h}, there.position(), turned);
    for (int i = 0; i < steps; ++i) back.step();
    for (std::size_t i = 0; i < q.size(); ++i) {
      EXPECT_NEAR(back.position()[i], q[i], 1e-9);
      EXPECT_NEAR(back.velocity()[i], -v[i], 1e-9);
    }
  };
  go_back(sprung_point_in_bowl(), 0.02, 120, {0.35, 1}, {0.4, 0});
  go_back(rod_on_floor(), 0.02, 150, {0, 1.5, 0.3}, {0.2, 0, 0.1});
  go_back(rod_on_floor(), 0.1, 20, {0, 0.6, 0.1}, {0, -3, 12});
}

// Both ends of a level rod meet the floor at once: it goes up again without a turn.
TEST(CollisionStructure, BothEndsAtOnce) {
  CollisionIntegrator rod(rod_on_floor(), {.step = 0.01}, {0, 1, 0}, {0.3, 0, 0});
  while (rod.totals().impacts == 0) rod.step();
  ASSERT_EQ(rod.impacts().size(), 1);
  const Impact& impact = rod.impacts().front();
  ASSERT_EQ(impact.parts.size(), 2);
  EXPECT_NEAR(impact.time, std::sqrt(2 / kWeight), 1e-12);
  EXPECT_NEAR(impact.parts[0].impulse, impact.parts[1].impulse, 1e-12);
  EXPECT_NEAR(impact.after[0], 0.3, 1e-15);
  EXPECT_NEAR(impact.after[1], -impact.before[1], kWeight * 0.01);
  EXPECT_NEAR(impact.after[2], 0, 1e-13);
  EXPECT_LE(impact.closest_point_error, 1e-13);
}

/// A point among random half-spaces and convex obstacles, with a random mass matrix and weight, in two or three coordinates.
MechanicalSystem random_system(std::mt19937_64& random, std::size_t n) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const auto size = static_cast<Eigen::Index>(n);
  const auto direction = [&] {
    std::vector<double> out(n);
    for (double& x : out) x = normal(random);
    const double length = Eigen::Map<Vec>(out.data(), size).norm();
    for (double& x : out) x /= length;
    return out;
  };
  MechanicalSystem system;
  const Mat root = Mat::NullaryExpr(size, size, [&] { return normal(random); });
  const Mat mass = root * root.transpose() + Mat::Identity(size, size);
  system.mass.assign(mass.data(), mass.data() + mass.size());
  for (std::size_t i = 0; i < n; ++i)  // exactly symmetric
    for (std::size_t j = 0; j < i; ++j) system.mass[i * n + j] = system.mass[j * n + i];
  add_gravity(system, 0, 4 * unit(random));
  for (std::size_t i = 0; i < n; ++i)
    for (const double sign : {1.0, -1.0}) {
      std::vector<double> box(n, 0);
      box[i] = sign;
      system.walls.push_back(half_space_wall("side", {box, -1}));
    }
  for (int k = 0; k < 2; ++k)  // cuts off corners of the box
    system.walls.push_back(half_space_wall("cut", {direction(), -0.8}));
  for (int k = 0; k < 2; ++k) {  // an obstacle that keeps 0.3 off the middle
    std::vector<HalfSpaceOfCoordinates> sides;
    for (int side = 0; side < 4; ++side)
      sides.push_back({direction(), -0.3 - (side > 0 ? 0.3 * unit(random) : 0)});
    system.walls.push_back(convex_obstacle("obstacle", sides));
  }
  return system;
}

TEST(CollisionStructure, RandomSystemsKeepWithinTheirWalls) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::int64_t impacts = 0, several = 0, grazing = 0, stopped = 0;
  for (int k = 0; k < 300; ++k) {
    const std::size_t n = 2 + k % 2;
    std::vector<double> q(n, 0), v(n);
    for (double& x : v) x = normal(random);
    CollisionIntegrator point(random_system(random, n), {.step = 0.1}, q, v);
    try {
      for (int i = 0; i < 300; ++i) {
        point.step();
        several += point.impacts().size() > 1;
        for (const Impact& impact : point.impacts()) {
          if (!impact.grazing) {
            ASSERT_NEAR(impact.energy_after, impact.energy, 1e-11 * (1 + impact.energy));
          }
        }
      }
    } catch (const RestingContact&) {
      ++stopped;
    } catch (const TooManyImpacts&) {
      ++stopped;
    }
    impacts += point.totals().impacts;
    grazing += point.totals().grazing_impacts;
    ASSERT_GE(point.totals().smallest_gap, -1e-12) << k;
    ASSERT_LE(point.totals().largest_closest_point_error, 1e-11) << k;
  }
  EXPECT_GT(impacts, 10000);
  EXPECT_GT(several, 300);
  EXPECT_LT(static_cast<double>(grazing + stopped), 1e-3 * static_cast<double>(impacts));
}

}  // namespace
}  // namespace scree::physics
