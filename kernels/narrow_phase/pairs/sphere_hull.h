#pragma once
// A sphere and a hull: the sphere is a point that is rounded.

#include "kernels/narrow_phase/pairs/convex_distance.h"
#include "kernels/narrow_phase/pairs/convex_shapes.h"

namespace scree {

struct SphereHull {
  using A = shapes::Sphere;
  using B = shapes::Hull;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    const ConvexCore point = core_of<A>(a, {}), hull = core_of<B>(b, d);
    const CoreDistance m = core_distance(point, hull, 1e300);
    ContactGeometry g;
    g.normal = m.normal;
    g.gap = m.separation - a.radius;
    g.arm_a = a.radius * g.normal;
    g.arm_b = g.arm_a + g.gap * g.normal - d;
    return g;
  }
};

}  // namespace scree
