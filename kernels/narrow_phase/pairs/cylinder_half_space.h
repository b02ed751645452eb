#pragma once
// A cylinder on a plane: four points of the rim of each end, the lowest one and those a quarter turn on. Where an end is
// level, these are fixed in the body.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/cylinder.h"
#include "shapes/half_space.h"

namespace scree {

struct CylinderHalfSpace {
  using A = shapes::Cylinder;
  using B = shapes::HalfSpace;
  static constexpr int kCorners = 8;
  /// Sine of the angle up to which an end counts as level.
  static constexpr double kLevel = 1e-6;

  /// @param corner  bits 0 and 1: quarter turns from the lowest point; bit 2: the end at positive z
  SCREE_HD static ContactGeometry contact(const PairSide& a, double height, const Vec3d& normal,
                                          const Vec3d& d, int corner) {
    const Vec3d down = rotate_back(a.orientation, -normal);
    const double slope = std::sqrt(down.x * down.x + down.y * down.y);
    double x = slope > kLevel ? down.x / slope : 1, y = slope > kLevel ? down.y / slope : 0;
    for (int turn = 0; turn < (corner & 3); ++turn) {
      const double before = x;
      x = -y;
      y = before;
    }
    const double r = a.half_extents.x;
    ContactGeometry g;
    g.arm_a = rotate(a.orientation,
                     Vec3d{r * x, r * y, corner & 4 ? a.half_extents.z : -a.half_extents.z});
    g.normal = -normal;
    g.gap = height + dot(normal, g.arm_a);
    g.arm_b = g.arm_a + g.gap * g.normal - d;
    return g;
  }
};

}  // namespace scree
