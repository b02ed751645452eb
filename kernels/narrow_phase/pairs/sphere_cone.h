#pragma once
// A sphere and a cone: in the plane through the axis and the center of the sphere, the cone is a triangle. A center inside
// leaves through the nearer of the round side and the base.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/cone.h"
#include "shapes/sphere.h"

namespace scree {

struct SphereCone {
  using A = shapes::Sphere;
  using B = shapes::Cone;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    const double r = b.half_extents.x, top = b.half_extents.z, base = B::base(b.half_extents);
    const Vec3d center = rotate_back(b.orientation, -d);
    const double across = std::sqrt(center.x * center.x + center.y * center.y), z = center.z;
    const double height = top - base, slant = std::sqrt(height * height + r * r);
    // Above the round side, along its normal, and below the base.
    const double beside = ((across - r) * height + (z - base) * r) / slant, below = base - z;
    double near_across, near_z, normal_across, normal_z, distance;
    if (beside <= 0 && below <= 0) {
      const bool is_side = beside > below;
      normal_across = is_side ? height / slant : 0;
      normal_z = is_side ? r / slant : -1;
      distance = is_side ? beside : below;
      near_across = across - distance * normal_across;
      near_z = z - distance * normal_z;
    } else {
      // The nearer of the nearest points of the base and of the side.
      const auto limited = [](double x) { return x > 0 ? (x < 1 ? x : 1.0) : 0.0; };
      const double t = limited(((across - r) * -r + (z - base) * height) / (slant * slant));
      const double side_across = r - t * r, side_z = base + t * height;
      const double base_across = across < r ? across : r;
      const auto square = [](double x) { return x * x; };
      const double to_side = square(across - side_across) + square(z - side_z);
      const double to_base = square(across - base_across) + square(z - base);
      near_across = to_side < to_base ? side_across : base_across;
      near_z = to_side < to_base ? side_z : base;
      distance = std::sqrt(to_side < to_base ? to_side : to_base);
      // Too near to tell: the side's.
      const bool is_clear = distance > 1e-12 * slant;
      normal_across = is_clear ? (across - near_across) / distance : height / slant;
      normal_z = is_clear ? (z - near_z) / distance : r / slant;
    }
    const double part = across > 0 ? 1 / across : 0;
    const Vec3d out = across > 0 ? Vec3d{part * center.x, part * center.y, 0} : Vec3d{1, 0, 0};
    const Vec3d up{0, 0, 1};
    ContactGeometry g;
    g.normal = rotate(b.orientation, -(normal_across * out + normal_z * up));
    g.gap = distance - a.radius;
    g.arm_a = a.radius * g.normal;
    g.arm_b = rotate(b.orientation, near_across * out + near_z * up);
    return g;
  }
};

}  // namespace scree
