#pragma once
// Two spheres.

#include "kernels/broad_phase/contact_range.h"
#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/sphere.h"

namespace scree {

/// @param d         center of A to center of B [m]
/// @param radius_a  [m]
/// @param radius_b  [m]
/// Coinciding centers are pushed apart along z. The gap has the same bits when A
/// and B change places.
SCREE_HD inline ContactGeometry sphere_sphere(const Vec3d& d, double radius_a, double radius_b) {
  const double distance = norm(d);
  ContactGeometry g;
  g.normal = distance > 0 ? d * (1 / distance) : Vec3d{0, 0, 1};
  g.gap = distance - (radius_a + radius_b);
  g.arm_a = radius_a * g.normal;
  g.arm_b = -radius_b * g.normal;
  return g;
}

struct SphereSphere {
  using A = shapes::Sphere;
  using B = shapes::Sphere;
  static constexpr int kFeatureBits = 0;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t) {
    return sphere_sphere(d, a.radius, b.radius);
  }
};

/// The same for spheres on straight ways. Where these miss each other, but would cut the plane
/// between the spheres at the start, that at their nearest pass takes its place, so that it does
/// not deflect them. The gap is again that of the two planes at the start.
/// What meets keeps the normal of the start, which leads through both centers: so impulses along
/// it keep the angular momentum.
/// @param g    sphere_sphere() at the start
/// @param way  of B relative to A in the step [m]
SCREE_HD inline ContactGeometry spheres_on_way(const ContactGeometry& g, const Vec3d& d,
                                               const Vec3d& way, double radius_a, double radius_b) {
  const double sum = radius_a + radius_b, least = kMinTurningWay * sum;
  const double a = norm2(way);
  if (!(g.gap > 0 && a > least * least && g.gap + dot(g.normal, way) < 0)) return g;
  const double nearest = -dot(d, way) / a;
  const Vec3d pass = d + (nearest < 1 ? nearest : 1) * way;
  const double distance = norm(pass);
  if (distance < sum) return g;
  ContactGeometry met;
  met.normal = pass * (1 / distance);
  met.gap = dot(met.normal, d) - sum;
  met.arm_a = radius_a * met.normal;
  met.arm_b = -radius_b * met.normal;
  return met;
}

}  // namespace scree
