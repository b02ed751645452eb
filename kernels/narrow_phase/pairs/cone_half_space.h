#pragma once
// A cone on a plane: its point, and four points of its rim: the lowest one and those a quarter turn on. Where the base is level,
// these are fixed in the body.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "kernels/narrow_phase/pairs/rim.h"
#include "shapes/cone.h"
#include "shapes/half_space.h"

namespace scree {

struct ConeHalfSpace {
  using A = shapes::Cone;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = 5;

  /// @param corner  0 to 3: quarter turns from the lowest point of the rim; 4: the point
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int corner) {
    const Vec3d& e = a.half_extents;
    const Vec3d down = rotate_back(a.orientation, -normal);
    const Vec3d x = corner == 4 ? Vec3d{0, 0, e.z} : rim_point(e.x, A::base(e), down, corner);
    return vertex_on_plane(rotate(a.orientation, x), height, normal, d);
  }
};

}  // namespace scree
