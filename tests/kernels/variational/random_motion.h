#pragma once
// Random bodies and motions for the tests of variational integrators.

#include <random>

#include "kernels/variational/rigid_path.h"

namespace scree {

inline Vec3d normal_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random);
  return {x, y, normal(random)};
}

inline Quatd random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random);
  return normalized(Quatd{w, x, y, normal(random)});
}

/// Principal moments that a body may have: none above the sum of the others. Some are slender.
inline Vec3d random_moments(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double a = 1e-3 + uniform(random), b = random() % 4 == 0 ? a : 1e-3 + uniform(random);
  const double low = std::abs(a - b) + 1e-3;
  const double c = low + (a + b - low) * uniform(random);
  return random() % 2 == 0 ? Vec3d{a, b, c} : Vec3d{c, a, b};
}

/// The rotation vector of a quaternion.
inline Vec3d turn_of(const Quatd& q) {
  const Vec3d v = q.vec();
  const double s = norm(v);
  if (s == 0) return {};
  const double angle = 2 * std::atan2(q.w < 0 ? -s : s, q.w < 0 ? -q.w : q.w);
  return (angle / s) * v;
}

}  // namespace scree
