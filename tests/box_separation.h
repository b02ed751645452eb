#pragma once
// How far two boxes are apart along the best of the axes that can separate them; negative: they overlap.

#include <algorithm>
#include <cmath>

#include "kernels/math/quat.h"

namespace scree::test {

/// @param half_a, q_a, half_b, q_b  half extents and orientations
/// @param between                   from the center of A to that of B
inline double box_separation(const Vec3<double>& half_a, const Quat<double>& q_a,
                             const Vec3<double>& half_b, const Quat<double>& q_b,
                             const Vec3<double>& between) {
  Vec3<double> axis[2][3];
  for (int k = 0; k < 3; ++k) {
    Vec3<double> unit;
    unit[k] = 1;
    axis[0][k] = rotate(q_a, unit);
    axis[1][k] = rotate(q_b, unit);
  }
  double most = -INFINITY;
  const auto offer = [&](const Vec3<double>& n) {
    const double length = norm(n);
    if (length < 1e-9) return;
    double shadow = 0;
    for (int k = 0; k < 3; ++k)
      shadow += half_a[k] * std::abs(dot(axis[0][k], n)) + half_b[k] * std::abs(dot(axis[1][k], n));
    most = std::max(most, (std::abs(dot(between, n)) - shadow) / length);
  };
  for (int a = 0; a < 3; ++a) {
    offer(axis[0][a]), offer(axis[1][a]);
    for (int b = 0; b < 3; ++b) offer(cross(axis[0][a], axis[1][b]));
  }
  return most;
}

}  // namespace scree::test
