#pragma once
// A sphere and an ellipsoid: at the point of the ellipsoid nearest to the center of the sphere.

#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/ellipsoid.h"
#include "shapes/sphere.h"

namespace scree {

struct SphereEllipsoid {
  using A = shapes::Sphere;
  using B = shapes::Ellipsoid;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    const Vec3d& e = b.half_extents;
    const Vec3d center = rotate_back(b.orientation, -d), closest = B::nearest(e, center);
    Vec3d normal, measure;  // of the surface; where the center is
    for (int k = 0; k < 3; ++k) {
      normal[k] = closest[k] / (e[k] * e[k]);
      measure[k] = center[k] / e[k];
    }
    const double distance = norm(center - closest);
    ContactGeometry g;
    g.normal = rotate(b.orientation, -normalized(normal));
    g.gap = (norm2(measure) < 1 ? -distance : distance) - a.radius;
    g.arm_a = a.radius * g.normal;
    g.arm_b = rotate(b.orientation, closest);
    return g;
  }
};

}  // namespace scree
