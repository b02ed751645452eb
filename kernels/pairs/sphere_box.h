#pragma once
// A sphere and a solid box.

#include "kernels/pairs/contact_geometry.h"

namespace scree {

/// Sphere A, box B. The contact is at the point of the box closest to the center of the sphere; a
/// center inside the box leaves through the nearest face.
/// @param d            center of A to center of B [m]
/// @param orientation  of the box, body to world
SCREE_HD inline ContactGeometry sphere_box(const Vec3d& d, double radius, const Quatd& orientation,
                                           const Vec3d& half_extents) {
  const Vec3d center = rotate_back(orientation, -d);
  Vec3d closest = center;
  bool inside = true;
  int nearest_axis = 0;
  double depth = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double limit = half_extents[axis];
    const double x = center[axis];
    if (x > limit || x < -limit) {
      inside = false;
      closest[axis] = x > limit ? limit : -limit;
    }
    const double axis_depth = limit - (x < 0 ? -x : x);
    if (axis == 0 || axis_depth < depth) {
      depth = axis_depth;
      nearest_axis = axis;
    }
  }
  Vec3d outward;  // body frame, out of the box
  double distance;
  if (inside) {
    const double side = center[nearest_axis] < 0 ? -1 : 1;
    outward[nearest_axis] = side;
    closest[nearest_axis] = side * half_extents[nearest_axis];
    distance = -depth;
  } else {
    const Vec3d offset = center - closest;
    distance = norm(offset);
    outward = offset * (1 / distance);
  }
  ContactGeometry g;
  g.normal = rotate(orientation, -outward);
  g.gap = distance - radius;
  g.arm_a = radius * g.normal;
  g.arm_b = rotate(orientation, closest);
  return g;
}

}  // namespace scree
