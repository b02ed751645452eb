#pragma once
// A box on a plane: the surface of a half-space, or a face of a container taken as an infinite
// plane. Each of the eight corners is a contact of its own.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "kernels/narrow_phase/pairs/rim.h"
#include "shapes/box.h"
#include "shapes/half_space.h"

namespace scree {

inline constexpr int kBoxCorners = 8;

/// Corner k of a box in its body frame: bit 0, 1, 2 of k set means the positive end of x, y, z.
SCREE_HD inline Vec3d box_corner(const Vec3d& half_extents, int k) {
  return {k & 1 ? half_extents.x : -half_extents.x, k & 2 ? half_extents.y : -half_extents.y,
          k & 4 ? half_extents.z : -half_extents.z};
}

/// Corner k of box A, half-space B.
/// @param height       center of the box above the plane [m], along `normal`
/// @param normal       unit, out of the half-space: bodies are on this side
/// @param d            center of A to center of B [m], for the lever arm of B
/// @param orientation  body to world
SCREE_HD inline ContactGeometry box_half_space(double height, const Vec3d& normal, const Vec3d& d,
                                               const Quatd& orientation, const Vec3d& half_extents,
                                               int corner) {
  return vertex_on_plane(rotate(orientation, box_corner(half_extents, corner)), height, normal, d);
}

struct BoxHalfSpace {
  using A = shapes::Box;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = kBoxCorners;
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int corner) {
    return box_half_space(height, normal, d, a.orientation, a.half_extents, corner);
  }
};

}  // namespace scree
