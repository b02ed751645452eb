#pragma once
// An ellipsoid on a plane: its lowest point.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "kernels/narrow_phase/pairs/rim.h"
#include "shapes/ellipsoid.h"
#include "shapes/half_space.h"

namespace scree {

struct EllipsoidHalfSpace {
  using A = shapes::Ellipsoid;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = 1;
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int) {
    const Vec3d lowest = A::extreme(a.half_extents, rotate_back(a.orientation, -normal));
    return vertex_on_plane(rotate(a.orientation, lowest), height, normal, d);
  }
};

}  // namespace scree
