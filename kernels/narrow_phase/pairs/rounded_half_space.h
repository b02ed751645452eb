#pragma once
// A rounded shape on a plane: the points by which its core would stand there, lowered by the radius.

#include "kernels/narrow_phase/pairs/box_half_space.h"
#include "kernels/narrow_phase/pairs/cone_half_space.h"
#include "kernels/narrow_phase/pairs/cylinder_half_space.h"
#include "kernels/narrow_phase/pairs/ellipsoid_half_space.h"
#include "kernels/narrow_phase/pairs/hull_half_space.h"
#include "kernels/narrow_phase/pairs/pair_types.h"
#include "shapes/rounded.h"

namespace scree {

struct RoundedHalfSpace {
  using A = shapes::Rounded;
  using B = shapes::HalfSpace;
  using Cores =
      PairTypes<BoxHalfSpace, CylinderHalfSpace, ConeHalfSpace, EllipsoidHalfSpace, HullHalfSpace>;
  static constexpr int kCorners = 8;

  /// A function of its own on a device: other shapes on planes keep their registers.
  /// @param corner  of the core, see its own pair function
  [[gnu::noinline]] SCREE_HD static ContactGeometry contact(const PairSide& a, double height,
                                                            const Vec3d& normal, const Vec3d& d,
                                                            int corner) {
    ContactGeometry g{-normal, INFINITY, {}, {}};
    const Vec3d shift = rotate(a.orientation, Vec3d{0, 0, a.rounded.shift});
    Cores::visit_plane(a.rounded.core, [&](auto pair) {
      using P = decltype(pair);
      static_assert(P::kCorners <= kCorners);
      if (corner < P::kCorners)
        g = P::contact(a, height + dot(normal, shift), normal, d - shift, corner);
    });
    if (!(g.gap < INFINITY)) return g;
    g.gap -= a.rounded.radius;
    g.arm_a += shift + a.rounded.radius * g.normal;
    g.arm_b = g.arm_a + g.gap * g.normal - d;
    return g;
  }
};

}  // namespace scree
