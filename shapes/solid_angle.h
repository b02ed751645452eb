#pragma once
// How large a triangle is seen from a point.

#include <array>
#include <cmath>

#include "shapes/shape.h"

namespace scree {

/// Above zero where the point is behind the triangle; of a closed surface all together are 4 pi from inside and zero from outside.
/// Source: Van Oosterom and Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 30(2), 1983.
inline double solid_angle(const std::array<Vec3d, 3>& corner, const Vec3d& from) {
  const Vec3d a = corner[0] - from, b = corner[1] - from, c = corner[2] - from;
  const double x = norm(a), y = norm(b), z = norm(c);
  return 2 *
         std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
}

}  // namespace scree
