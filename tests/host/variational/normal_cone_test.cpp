// Projection on normal cones, against all choices of generators.

#include "host/variational/normal_cone.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace scree::variational {
namespace {

Matrix random_matrix(std::mt19937_64& random, int rows, int columns) {
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr(rows, columns, [&] { return normal(random); });
}

/// Least distance of p to the cone { -G x : x >= 0 } in the metric M^-1: that of the best face whose multipliers are not negative.
double distance_by_faces(const Matrix& mass, const Matrix& g, const Vector& p) {
  const Matrix inverse = mass.inverse();
  double least = std::sqrt(p.dot(inverse * p));
  for (int face = 1; face < 1 << g.cols(); ++face) {
    std::vector<int> chosen;
    for (int j = 0; j < g.cols(); ++j)
      if (face >> j & 1) chosen.push_back(j);
    const Matrix part = g(Eigen::all, chosen);
    const Matrix gram = part.transpose() * inverse * part;
    const Vector x = gram.fullPivLu().solve(-part.transpose() * inverse * p);
    if ((x.array() < -1e-12).any()) continue;
    const Vector rest = p + part * x;
    least = std::min(least, std::sqrt(rest.dot(inverse * rest)));
  }
  return least;
}

TEST(NormalCone, IsTheNearestPointOfAllFaces) {
  std::mt19937_64 random(3);
  for (int k = 0; k < 500; ++k) {
    const int n = 1 + k % 4, count = 1 + k % 5;
    const Matrix root = random_matrix(random, n, n);
    const Matrix mass = root * root.transpose() + 0.1 * Matrix::Identity(n, n);
    Matrix g = random_matrix(random, n, count);
    if (k % 7 == 0) g.col(count - 1) = 2 * g.col(0);  // one generator twice
    const Vector p = random_matrix(random, n, 1);
    const Metric metric({mass.data(), mass.data() + n * n}, n);
    const ConeProjection found = project_on_normal_cone(metric, g, p);
    EXPECT_GE(found.multipliers.minCoeff(), 0);
    EXPECT_NEAR(found.distance, distance_by_faces(mass, g, p), 1e-9 * (1 + p.norm())) << k;
    const Vector rest = p + g * found.multipliers;
    EXPECT_NEAR(found.distance, std::sqrt(rest.dot(mass.inverse() * rest)), 1e-9);
  }
}

TEST(NormalCone, PointsOfItAreTheirOwnProjection) {
  const Metric metric({2, 0, 0, 1}, 2);
  const Matrix g{{1, 0}, {0, 1}};
  const ConeProjection inside = project_on_normal_cone(metric, g, Vector{{-3, -4}});
  EXPECT_NEAR(inside.distance, 0, 1e-15);
  EXPECT_NEAR(inside.multipliers[0], 3, 1e-15);
  EXPECT_NEAR(inside.multipliers[1], 4, 1e-15);
  const ConeProjection away = project_on_normal_cone(metric, g, Vector{{3, 4}});
  EXPECT_EQ(away.multipliers, Vector::Zero(2));
  EXPECT_NEAR(away.distance, std::sqrt(9.0 / 2 + 16), 1e-14);
}

}  // namespace
}  // namespace scree::variational
