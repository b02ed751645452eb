#pragma once
// Periodic directions: a vector of period lengths, zero where space does not repeat.

#include "kernels/math/vec3.h"

namespace scree {

/// The shortest image of a displacement.
/// @param d       displacement [m], of any number of periods
/// @param period  period per axis [m]; zero: not periodic
SCREE_HD inline Vec3<double> minimum_image(Vec3<double> d, const Vec3<double>& period) {
  if (period.x > 0) d.x -= period.x * std::rint(d.x / period.x);
  if (period.y > 0) d.y -= period.y * std::rint(d.y / period.y);
  if (period.z > 0) d.z -= period.z * std::rint(d.z / period.z);
  return d;
}

}  // namespace scree
