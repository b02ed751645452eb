#pragma once
// A sphere and a rounded shape: the sphere is a point that is rounded.

#include "kernels/narrow_phase/pairs/convex_distance.h"
#include "kernels/narrow_phase/pairs/convex_shapes.h"

namespace scree {

struct SphereRounded {
  using A = shapes::Sphere;
  using B = shapes::Rounded;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    const ConvexCore point = core_of<A>(a, {}), core = core_of<B>(b, d);
    const CoreDistance m = core_distance(point, core, 1e300);
    ContactGeometry g;
    g.normal = m.normal;
    g.gap = m.separation - a.radius - core.rounding;
    g.arm_a = a.radius * g.normal;
    g.arm_b = g.arm_a + g.gap * g.normal - d;
    return g;
  }
};

}  // namespace scree
