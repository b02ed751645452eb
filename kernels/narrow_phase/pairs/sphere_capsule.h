#pragma once
// A sphere and a capsule: as two spheres, one of them at the point of the axis nearest to the other.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/capsule.h"

namespace scree {

/// Sphere A, capsule B. Spheres centered on the axis leave along x of the capsule.
/// @param d            center of A to center of B [m]
/// @param orientation  of the capsule, body to world
SCREE_HD inline ContactGeometry sphere_capsule(const Vec3d& d, double radius,
                                               const Quatd& orientation,
                                               const Vec3d& half_extents) {
  const Vec3d center = rotate_back(orientation, -d);
  const Vec3d middle = shapes::Capsule::on_axis(half_extents, center), offset = center - middle;
  const double own = shapes::Capsule::radius(half_extents);
  const Vec3d outward = normalized(offset, {1, 0, 0});
  ContactGeometry g;
  g.normal = rotate(orientation, -outward);
  g.gap = norm(offset) - (radius + own);
  g.arm_a = radius * g.normal;
  g.arm_b = rotate(orientation, middle + own * outward);
  return g;
}

struct SphereCapsule {
  using A = shapes::Sphere;
  using B = shapes::Capsule;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    return sphere_capsule(d, a.radius, b.orientation, b.half_extents);
  }
};

}  // namespace scree
