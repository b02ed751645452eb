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
  static constexpr int kCorners = 8;

  /// @param corner  of the face; of faces with more than eight, that part of the way around
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int corner) {
    const Hull& hull = a.hull;
    const Vec3d down = rotate_back(a.orientation, -normal);
    const std::uint32_t lowest = hull.farthest(down), face = hull.facing(lowest, down);
    const std::uint32_t count = hull.face[face].count, k = static_cast<std::uint32_t>(corner);
    if (k >= count) return {-normal, INFINITY, {}, {}};
    constexpr std::uint32_t kMost = kCorners;
    std::uint32_t at = hull.corner_of(face, k);
    if (count > kMost) {
      // The lowest point is among those that are taken.
      std::uint32_t first = 0;
      while (hull.corner_of(face, first) != lowest) ++first;
      at = hull.corner_of(face, (first + k * count / kMost) % count);
    }
    return vertex_on_plane(rotate(a.orientation, hull.scale * hull.point[at]), height, normal, d);
  }
};

}  // namespace scree
