#pragma once
// The point of a triangle closest to a point, with the feature it lies on.
// Source: Ericson, Real-Time Collision Detection, 2005, section 5.1.5.

#include "kernels/narrow_phase/pairs/contact_geometry.h"

namespace scree {

enum class TriangleFeature : std::uint8_t { face, edge, vertex };

struct TrianglePoint {
  Vec3d point;  ///< closest point [m]
  TriangleFeature feature = TriangleFeature::face;
  int index = 0;  ///< vertex: which; edge: k for the edge from vertex k to vertex (k + 1) % 3
};

/// Closest point of the triangle (a, b, c) to p.
SCREE_HD inline TrianglePoint closest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b,
                                                  const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, TriangleFeature::vertex, 0};
  const Vec3d bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, TriangleFeature::vertex, 1};
  const Vec3d cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, TriangleFeature::vertex, 2};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return {a + (d1 > d3 ? d1 / (d1 - d3) : 0) * ab, TriangleFeature::edge, 0};
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return {a + (d2 > d6 ? d2 / (d2 - d6) : 0) * ac, TriangleFeature::edge, 2};
  }
  const double va = d3 * d6 - d5 * d4;
  const double along = d4 - d3, rest = d5 - d6;
  if (va <= 0 && along >= 0 && rest >= 0) {
    return {b + (along + rest > 0 ? along / (along + rest) : 0) * (c - b), TriangleFeature::edge,
            1};
  }
  const double scale = 1 / (va + vb + vc);
  return {a + (vb * scale) * ab + (vc * scale) * ac, TriangleFeature::face, 0};
}

/// Sphere A against a point B of a surface whose outward direction there is known.
/// @param offset    surface point to center of the sphere [m]
/// @param fallback  unit outward direction of the surface, used when the center lies on it
/// @param arm_b     center of B to the surface point [m]
SCREE_HD inline ContactGeometry sphere_surface_point(const Vec3d& offset, const Vec3d& fallback,
                                                     const Vec3d& arm_b, double radius) {
  const double distance = norm(offset);
  ContactGeometry g;
  g.normal = distance > 0 ? offset * (-1 / distance) : -fallback;
  g.gap = distance - radius;
  g.arm_a = radius * g.normal;
  g.arm_b = arm_b;
  return g;
}

}  // namespace scree
