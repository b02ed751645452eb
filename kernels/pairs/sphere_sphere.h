#pragma once
// Two spheres.

#include "kernels/pairs/contact_geometry.h"

namespace scree {

/// @param d         center of A to center of B [m]
/// @param radius_a  [m]
/// @param radius_b  [m]
/// Coinciding centers are pushed apart along z. The gap has the same bits when A and B change
/// places.
SCREE_HD inline ContactGeometry sphere_sphere(const Vec3d& d, double radius_a, double radius_b) {
  const double distance = norm(d);
  ContactGeometry g;
  g.normal = distance > 0 ? d * (1 / distance) : Vec3d{0, 0, 1};
  g.gap = distance - (radius_a + radius_b);
  g.arm_a = radius_a * g.normal;
  g.arm_b = -radius_b * g.normal;
  return g;
}

}  // namespace scree
