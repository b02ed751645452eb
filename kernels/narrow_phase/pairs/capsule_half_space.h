#pragma once
// A capsule on a plane. Each of its ends is a contact of its own.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/capsule.h"
#include "shapes/half_space.h"

namespace scree {

/// An end of capsule A, half-space B.
/// @param height       center of the capsule above the plane [m], along `normal`
/// @param normal       unit, out of the half-space: bodies are on this side
/// @param d            center of A to center of B [m], for the lever arm of B
/// @param orientation  body to world
/// @param end          0: at negative z of the body, 1: at positive z
SCREE_HD inline ContactGeometry capsule_half_space(double height, const Vec3d& normal,
                                                   const Vec3d& d, const Quatd& orientation,
                                                   const Vec3d& half_extents, int end) {
  const double z = shapes::Capsule::half_length(half_extents);
  const double radius = shapes::Capsule::radius(half_extents);
  const Vec3d center = rotate(orientation, Vec3d{0, 0, end == 0 ? -z : z});
  ContactGeometry g;
  g.normal = -normal;
  g.gap = height + dot(normal, center) - radius;
  g.arm_a = center + radius * g.normal;
  g.arm_b = g.arm_a + g.gap * g.normal - d;
  return g;
}

struct CapsuleHalfSpace {
  using A = shapes::Capsule;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = 2;
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int corner) {
    return capsule_half_space(height, normal, d, a.orientation, a.half_extents, corner);
  }
};

}  // namespace scree
