#pragma once
// A hull on a plane: the corners of the face that looks down at its lowest point, up to eight.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "kernels/narrow_phase/pairs/rim.h"
#include "shapes/half_space.h"
#include "shapes/hull.h"

namespace scree {

struct HullHalfSpace {
  using A = shapes::Hull;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = Hull::kMostCorners;

  /// @param corner  of the face, see Hull::shown_corner()
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int corner) {
    const Hull& hull = a.hull;
    const Vec3d down = rotate_back(a.orientation, -normal);
    const std::uint32_t lowest = hull.farthest(down), face = hull.facing(lowest, down);
    const std::uint32_t k = static_cast<std::uint32_t>(corner);
    if (k >= hull.shown_count(face)) return {-normal, INFINITY, {}, {}};
    const Vec3d& point = hull.point[hull.shown_corner(face, k, lowest)];
    return vertex_on_plane(rotate(a.orientation, hull.scale * point), height, normal, d);
  }
};

}  // namespace scree
