// Projections on friction pyramids, by the conditions that single them out.
#include "solvers/assembled/pyramid_projection.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "solvers/assembled/friction_pyramid.h"

namespace scree {
namespace {

using Vec = std::array<double, 3>;

Vec projected(int sides, double mu, Vec x) {
  project_on_pyramid(sides, mu, x.data());
  return x;
}

class PyramidProjection : public ::testing::TestWithParam<int> {
 protected:
  std::mt19937 generator{5};
  std::normal_distribution<double> normal;
  Vec random() { return {normal(generator), normal(generator), normal(generator)}; }
};
INSTANTIATE_TEST_SUITE_P(Sides, PyramidProjection, ::testing::Values(4, 6, 8));

/// p = sum l_j (1, mu e_j) is the nearest point when x - p is orthogonal to p and leads away from
/// all corners; l_j >= 0 when p is in all half spaces of the faces.
TEST_P(PyramidProjection, IsFeasibleAndOrthogonal) {
  const int sides = GetParam();
  for (int k = 0; k < 2000; ++k) {
    const double mu = k % 10 == 0 ? 0 : 0.1 * (k % 13);
    const Vec x = random(), p = projected(sides, mu, x);
    double orthogonal = 0;
    for (int i = 0; i < 3; ++i) orthogonal += p[i] * (x[i] - p[i]);
    EXPECT_NEAR(orthogonal, 0, 1e-13);
    const double half = std::numbers::pi / sides;
    for (int j = 0; j < sides; ++j) {
      const PyramidEdge e = Pyramid(sides).edge[j];
      EXPECT_LE(x[0] - p[0] + mu * (e.t1 * (x[1] - p[1]) + e.t2 * (x[2] - p[2])), 1e-13);
      const double angle = (2 * j + 1) * half;
      EXPECT_LE(std::cos(angle) * p[1] + std::sin(angle) * p[2] - mu * std::cos(half) * p[0],
                1e-13);
    }
    EXPECT_GE(p[0], 0);
  }
}

/// The set is a polyhedron: close to x, projections are those on the tangent cone, without error.
TEST_P(PyramidProjection, TangentConesAreTheirDerivative) {
  const int sides = GetParam();
  constexpr double step = 1e-6;
  for (int k = 0; k < 2000; ++k) {
    const double mu = k % 10 == 0 ? 0 : 0.1 * (1 + k % 13);
    const Vec x = projected(sides, mu, random());  // inside, on faces, on edges and the apex
    const Vec v = random();
    Vec there;
    for (int i = 0; i < 3; ++i) there[i] = x[i] + step * v[i];
    // A point closer to another face than the step is long would meet that face too.
    if (x[0] > 0 && x[0] < 0.05) continue;
    const Vec p = projected(sides, mu, there);
    Vec w = v;
    project_on_pyramid_tangent(sides, mu, x.data(), w.data());
    Vec beside = x;
    for (int i = 0; i < 3; ++i) beside[i] += 10 * step * w[i];
    const Vec kept = projected(sides, mu, beside);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(kept[i], beside[i], 1e-13) << "not feasible, case " << k;
      EXPECT_NEAR(p[i], x[i] + step * w[i], 1e-13) << "case " << k;
    }
  }
}

}  // namespace
}  // namespace scree
