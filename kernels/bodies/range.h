#pragma once
// How far from the origin, and how fast, bodies may be: squares and products of such lengths and
// speeds stay within single precision, and the numbers of bins within Index.

#include "kernels/math/vec3.h"

namespace scree {

/// Coordinates, and the way of a body in one step [m].
inline constexpr double kFarthest = 1e15;
/// [m/s]
inline constexpr double kFastest = 1e15;
/// Radius about a body that holds all it may touch: a few lengths of up to kFarthest [m].
inline constexpr double kMostReach = 16 * kFarthest;

/// False for numbers that are not finite, too.
SCREE_HD inline bool is_in_range(const Vec3<double>& x) {
  return x.x >= -kFarthest && x.x <= kFarthest && x.y >= -kFarthest && x.y <= kFarthest &&
         x.z >= -kFarthest && x.z <= kFarthest;
}

/// @param h  time step [s]
SCREE_HD inline bool is_speed_in_range(double speed, double h) {
  return speed <= kFastest && h * speed <= kFarthest;
}

}  // namespace scree
