#pragma once
// Vertices on planes, and which points of a round rim these are.

#include "kernels/narrow_phase/pairs/contact_geometry.h"

namespace scree {

/// A point of body A on a plane.
/// @param arm     from the center of A, world axes [m]
/// @param height  center of A above the plane [m]
/// @param d       center of A to that of the wall [m]
SCREE_HD inline ContactGeometry vertex_on_plane(const Vec3d& arm, double height,
                                                const Vec3d& normal, const Vec3d& d) {
  ContactGeometry g;
  g.arm_a = arm;
  g.normal = -normal;
  g.gap = height + dot(normal, arm);
  g.arm_b = arm + g.gap * g.normal - d;
  return g;
}

/// Sine of the angle up to which a rim counts as level.
inline constexpr double kLevelRim = 1e-6;

/// A point of a rim about z of a body, body frame [m]: the lowest one, or some quarter turns on.
/// @param down  out of the plane toward the body, reversed, body frame
SCREE_HD inline Vec3d rim_point(double radius, double z, const Vec3d& down, int turns) {
  const double slope = std::sqrt(down.x * down.x + down.y * down.y);
  double x = slope > kLevelRim ? down.x / slope : 1, y = slope > kLevelRim ? down.y / slope : 0;
  for (int turn = 0; turn < turns; ++turn) {
    const double before = x;
    x = -y;
    y = before;
  }
  return {radius * x, radius * y, z};
}

}  // namespace scree
