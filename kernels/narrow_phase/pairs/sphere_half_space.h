#pragma once
// A sphere on a plane: the surface of a half-space, or a face of a container taken
// as an infinite plane.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/half_space.h"
#include "shapes/sphere.h"

namespace scree {

/// Sphere A, half-space B.
/// @param height  center of the sphere above the plane [m], along `normal`
/// @param normal  unit, out of the half-space: bodies are on this side
/// @param d       center of A to center of B [m], for the lever arm of B
SCREE_HD inline ContactGeometry sphere_half_space(double height, const Vec3d& normal,
                                                  const Vec3d& d, double radius) {
  ContactGeometry g;
  g.normal = -normal;
  g.gap = height - radius;
  g.arm_a = radius * g.normal;
  g.arm_b = height * g.normal - d;
  return g;
}

struct SphereHalfSpace {
  using A = shapes::Sphere;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = 1;
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int) {
    return sphere_half_space(height, normal, d, a.radius);
  }
};

}  // namespace scree
