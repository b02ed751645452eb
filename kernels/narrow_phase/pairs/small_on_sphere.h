#pragma once
// A small body that goes fast, by more than half of its half thickness a step, against a sphere of some times its size. Their one
// contact stops the point that would touch, but where that lies off the center the body spins and its center goes on, deep into the
// sphere. So there the ball of MiddleContact meets the sphere in place of the body: its center stays outside, and what of the body is
// inside then the contact of the next step takes out. Slower and larger bodies go less deep with their own contact.

#include <type_traits>

#include "kernels/narrow_phase/pairs/middle_contact.h"
#include "kernels/narrow_phase/pairs/sphere_sphere.h"

namespace scree {

struct SmallOnSphere {
  /// Part of the least half thickness by which the center passes the normal: nearer, the contact stops the center too, or all but a few hundredths of its speed.
  static constexpr double kAside = 0.1;
  /// Way in a step, along the normal, over the least half thickness: more than scenes should have.
  static constexpr double kFast = 0.5;
  /// Radius of the sphere over the farthest reach of the body: a ball in place of a larger one would sink in visibly.
  static constexpr double kSmall = 4;

  /// @param g  of the sphere A and body B, and out
  SCREE_HD static ContactGeometry followed(const ContactGeometry& g, const PairSide& a,
                                           const PairSide& b, const Vec3d& d) {
    const double approach = -dot(g.normal, b.way);
    if (!(approach > 0)) return g;
    const Vec3d& half = b.half_extents;
    const double least = smaller(smaller(half.x, half.y), half.z) + b.rounded.radius;
    const double most = -smaller(smaller(-half.x, -half.y), -half.z) + b.rounded.reach();
    if (!(approach > kFast * least && kSmall * most <= a.radius)) return g;
    const Vec3d aside = g.arm_b - dot(g.arm_b, g.normal) * g.normal;
    if (norm2(aside) < kAside * kAside * least * least) return g;
    return sphere_sphere(d, a.radius, MiddleContact::kBall * least);
  }

 private:
  SCREE_HD static double smaller(double x, double y) { return x < y ? x : y; }
};

/// The contact of a pair that a feature names.
template <class P>
SCREE_HD ContactGeometry pair_contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                      std::uint32_t feature) {
  const ContactGeometry g = P::contact(a, b, d, feature);
  if constexpr (P::kFeatureBits == 0) {  // A is a sphere
    if constexpr (!std::is_same_v<typename P::B, shapes::Sphere>)
      return SmallOnSphere::followed(g, a, b, d);
  }
  return g;
}

}  // namespace scree
