// The collision integrator in other coordinates, and with the symmetry of a circle.

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/physics/collision_systems.h"

namespace scree::physics {
namespace {

using Vec = Eigen::VectorXd;
using Mat = Eigen::MatrixXd;

std::vector<double> list(const Mat& m) {
  return {m.data(), m.data() + m.size()};  // symmetric ones and vectors only
}
Vec vec(std::span<const double> x) {
  return Eigen::Map<const Vec>(x.data(), static_cast<Eigen::Index>(x.size()));
}

/// Three coordinates with a mass matrix, a quadratic potential, walls that lean against each other, and losses at some of them:
/// in coordinates x with q = A x.
CollisionIntegrator in_coordinates(const Mat& a, double h) {
  Mat mass(3, 3), stiffness(3, 3);
  mass << 2, 0.3, -0.2, 0.3, 1, 0.1, -0.2, 0.1, 0.7;
  stiffness << 3, 1, 0, 1, 2, 0.5, 0, 0.5, 1;
  MechanicalSystem system;
  const Mat own_mass = a.transpose() * mass * a;
  system.mass = list(0.5 * (own_mass + own_mass.transpose()));
  system.potential = [=](std::span<const double> x) {
    const Vec q = a * vec(x);
    return 0.5 * q.dot(stiffness * q) + q[2];
  };
  system.potential_gradient = [=](std::span<const double> x, std::span<double> gradient) {
    const Vec force = stiffness * (a * vec(x)) + Vec::Unit(3, 2);
    Eigen::Map<Vec>(gradient.data(), 3) = a.transpose() * force;
  };
  const auto side = [&](const Vec& normal, double offset) {
    return HalfSpaceOfCoordinates{list(a.transpose() * normal), offset};
  };
  system.walls = {
      half_space_wall("floor", side(Vec::Unit(3, 2), -0.8)),
      half_space_wall("left", side(Vec{{1, 0.2, 0}}, -0.7)),
      half_space_wall("right", side(Vec{{-1, 0.3, 0.1}}, -0.9)),
      convex_obstacle("edge", {side(Vec{{0, 1, 0.2}}, -0.1), side(Vec{{1, -1, 0}}, 0.6)})};
  system.walls[1].restitution = 0.95;
  system.walls[2].friction = 0.1;
  const Vec q{{0.1, 0.3, 0.4}}, v{{1.1, -0.9, 0.3}};
  const Mat inverse = a.inverse();
  return {std::move(system), {.step = h}, list(inverse * q), list(inverse * v)};
}

// Directions, friction and energies are those of the metric M: no coordinates are preferred.
TEST(CollisionMetric, MotionDoesNotDependOnCoordinates) {
  Mat a(3, 3);
  a << 1.3, 0.4, -0.2, 0.1, 0.8, 0.5, -0.3, 0.2, 1.7;
  CollisionIntegrator plain = in_coordinates(Mat::Identity(3, 3), 0.05);
  CollisionIntegrator other = in_coordinates(a, 0.05);
  double difference = 0;
  for (int i = 0; i < 400; ++i) {
    plain.step();
    other.step();
    difference = std::max(difference, (vec(plain.position()) - a * vec(other.position())).norm());
    ASSERT_NEAR(plain.energy(), other.energy(), 1e-9) << i;
  }
  EXPECT_GT(plain.totals().impacts, 20);
  EXPECT_EQ(plain.totals().impacts, other.totals().impacts);
  EXPECT_LE(difference, 1e-9);
}

// A circle and a central potential: the angular momentum stays, to rounding, and the energy but for its bounded part.
TEST(CollisionMetric, AngularMomentumInACircle) {
  MechanicalSystem system = unit_masses(2);
  system.potential = [](std::span<const double> q) { return 0.5 * (q[0] * q[0] + q[1] * q[1]); };
  system.potential_gradient = [](std::span<const double> q, std::span<double> gradient) {
    gradient[0] = q[0];
    gradient[1] = q[1];
  };
  system.walls = {quadric_wall("circle", {-2, 0, 0, -2}, {0, 0}, 1)};
  system.momenta = {angular_momentum("L", {0, -1, 1, 0})};
  CollisionIntegrator point(std::move(system), {.step = 0.02}, {0.3, 0.2}, {1.4, 0.9});
  const double momentum = point.momenta()[0], energy = point.energy();
  EXPECT_NEAR(momentum, 0.3 * 0.9 - 0.2 * 1.4, 1e-15);
  for (int i = 0; i < 100000; ++i) {
    point.step();
    ASSERT_NEAR(point.momenta()[0], momentum, 1e-12) << i;
    ASSERT_NEAR(point.energy() / energy, 1, 5e-3) << i;
  }
  EXPECT_GT(point.totals().impacts, 1000);
  EXPECT_EQ(point.totals().grazing_impacts, 0);
}

}  // namespace
}  // namespace scree::physics
