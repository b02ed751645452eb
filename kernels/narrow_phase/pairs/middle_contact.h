#pragma once
// A contact of the middle of a body that goes far in a step for its thickness. One contact off its center stops the point that
// would touch, but the center goes on as the body spins: an ellipsoid that meets a thin wall askew would be behind it after the step.
// So a ball inside, about its center of mass, meets the plane between the bodies as well. The ball is a part of the body, and the plane
// one that parts the bodies at the start, so the contact keeps apart nothing that should come together.

#include "kernels/narrow_phase/pairs/contact_geometry.h"
#include "kernels/narrow_phase/pairs/convex_core.h"

namespace scree {

struct MiddleContact {
  /// Radius of the ball over the least half thickness: of a flat cone or a tetrahedron the center of mass is nearer to a face.
  static constexpr double kBall = 0.4;
  /// Way in a step from which bodies have one, in the same measure: what spins fast has contacts that part as it comes nearer.
  static constexpr double kFast = 0.3;

  /// The smaller body has it, of a body and a triangle the body. @param way  of the second relative to the first in the step [m]
  SCREE_HD static bool is_wanted(const ConvexCore& first, const ConvexCore& second,
                                 const Vec3d& normal, const Vec3d& way) {
    const double thickness = is_of_first(first, second) ? first.thickness() : second.thickness();
    return -dot(normal, way) > kFast * thickness;
  }
  /// @param d  center of mass of the first, from which cores are placed, to that of the second [m]
  SCREE_HD static ContactGeometry geometry(const ConvexCore& first, const ConvexCore& second,
                                           const Vec3d& normal, const Vec3d& d) {
    ContactGeometry g;
    g.normal = normal;
    if (is_of_first(first, second)) {
      const Vec3d other = second.center + second.support(-normal);
      g.arm_a = kBall * first.thickness() * normal;
      g.gap = dot(other - g.arm_a, normal) - second.rounding;
      g.arm_b = g.arm_a + g.gap * normal - d;
    } else {
      const Vec3d other = first.center + first.support(normal);
      g.arm_b = -kBall * second.thickness() * normal;
      g.gap = dot(d + g.arm_b - other, normal) - first.rounding;
      g.arm_a = d + g.arm_b - g.gap * normal;
    }
    return g;
  }

 private:
  SCREE_HD static bool is_of_first(const ConvexCore& first, const ConvexCore& second) {
    return second.form == ConvexCore::Form::triangle || first.size() <= second.size();
  }
};

}  // namespace scree
