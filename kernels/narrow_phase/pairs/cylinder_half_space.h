#pragma once
// A cylinder on a plane: four points of the rim of each end, the lowest one and those a quarter turn on. Where an end is
// level, these are fixed in the body.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "kernels/narrow_phase/pairs/rim.h"
#include "shapes/cylinder.h"
#include "shapes/half_space.h"

namespace scree {

struct CylinderHalfSpace {
  using A = shapes::Cylinder;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = 8;

  /// @param corner  bits 0 and 1: quarter turns from the lowest point; bit 2: the end at positive z
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int corner) {
    const Vec3d& e = a.half_extents;
    const Vec3d down = rotate_back(a.orientation, -normal);
    const Vec3d x = rim_point(e.x, corner & 4 ? e.z : -e.z, down, corner & 3);
    return vertex_on_plane(rotate(a.orientation, x), height, normal, d);
  }
};

}  // namespace scree
