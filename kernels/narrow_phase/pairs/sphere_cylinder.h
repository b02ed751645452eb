#pragma once
// A sphere and a cylinder: at the point of the cylinder nearest to the center of the sphere. A center inside leaves
// through the nearer of the round side and an end.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/cylinder.h"
#include "shapes/sphere.h"

namespace scree {

/// Sphere A, cylinder B.
/// @param d            center of A to center of B [m]
/// @param orientation  of the cylinder, body to world
SCREE_HD inline ContactGeometry sphere_cylinder(const Vec3d& d, double radius,
                                                const Quatd& orientation,
                                                const Vec3d& half_extents) {
  const Vec3d center = rotate_back(orientation, -d);
  Vec3d closest = shapes::Cylinder::nearest(half_extents, center);
  Vec3d outward = center - closest;
  double distance = norm(outward);
  if (distance > 0) {
    outward *= 1 / distance;
  } else {
    const Vec3d across{center.x, center.y, 0};
    const double side = half_extents.x - norm(across), end = half_extents.z - std::abs(center.z);
    outward = side < end ? normalized(across, {1, 0, 0}) : Vec3d{0, 0, center.z < 0 ? -1.0 : 1.0};
    distance = side < end ? -side : -end;
    closest = center - distance * outward;
  }
  ContactGeometry g;
  g.normal = rotate(orientation, -outward);
  g.gap = distance - radius;
  g.arm_a = radius * g.normal;
  g.arm_b = rotate(orientation, closest);
  return g;
}

struct SphereCylinder {
  using A = shapes::Sphere;
  using B = shapes::Cylinder;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    return sphere_cylinder(d, a.radius, b.orientation, b.half_extents);
  }
};

}  // namespace scree
