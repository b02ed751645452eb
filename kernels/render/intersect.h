#pragma once
// Exact ray intersections. Each returns the depth at which the ray enters (container: leaves) the
// solid, or kMiss. The caller rejects depths in front of the near plane.

#include "kernels/render/view.h"

namespace scree::render {

inline constexpr float kMiss = -1e30f;

/// Sphere around the frame's origin. Works with the point of closest approach, which keeps its
/// digits when the sphere is small and far away.
SCREE_HD inline float hit_sphere(const Ray& ray, float radius) {
  const float inv_dd = 1.0f / norm2(ray.direction);
  const float t_closest = -dot(ray.origin, ray.direction) * inv_dd;
  const Vec3f closest = ray.origin + t_closest * ray.direction;
  const float inside = radius * radius - norm2(closest);
  if (inside < 0.0f) return kMiss;
  return t_closest - std::sqrt(inside * inv_dd);
}

/// Where a ray enters and leaves an axis-aligned box around the frame's origin.
struct BoxSpan {
  float enter = -1e30f;
  float leave = 1e30f;
  int enter_axis = 0;
  int leave_axis = 0;
};

SCREE_HD inline BoxSpan span_in_box(const Ray& ray, const Vec3f& half_extents) {
  BoxSpan span;
  for (int axis = 0; axis < 3; ++axis) {
    float d = ray.direction[axis];
    if (std::abs(d) < kTiny) d = kTiny;
    const float inv = 1.0f / d;
    const float middle = -ray.origin[axis] * inv;
    const float half = half_extents[axis] * std::abs(inv);
    if (middle - half > span.enter) span.enter = middle - half, span.enter_axis = axis;
    if (middle + half < span.leave) span.leave = middle + half, span.leave_axis = axis;
  }
  return span;
}

SCREE_HD inline float hit_box(const Ray& ray, const Vec3f& half_extents) {
  const BoxSpan span = span_in_box(ray, half_extents);
  return span.enter <= span.leave ? span.enter : kMiss;
}

/// Index 0..5 (-x +x -y +y -z +z) of the container face through which the ray leaves.
SCREE_HD inline int leaving_face(const Ray& ray, const BoxSpan& span) {
  return 2 * span.leave_axis + (ray.direction[span.leave_axis] > 0.0f ? 1 : 0);
}

/// Inner side of the container faces. Faces between the eye and the inside are never hit, so they
/// hide nothing; a ray that leaves through a missing face goes on.
SCREE_HD inline float hit_container(const Ray& ray, const Vec3f& half_extents,
                                    unsigned open_faces) {
  const BoxSpan span = span_in_box(ray, half_extents);
  if (span.enter > span.leave) return kMiss;
  return ((open_faces >> leaving_face(ray, span)) & 1u) != 0 ? kMiss : span.leave;
}

/// Plane through the frame's origin, seen from the side its normal points to.
SCREE_HD inline float hit_plane(const Ray& ray, const Vec3f& normal) {
  const float slope = dot(ray.direction, normal);
  const float height = dot(ray.origin, normal);
  return slope < -1e-6f && height > 0.0f ? -height / slope : kMiss;
}

/// Triangle a, a + edge1, a + edge2.
/// @param one_sided  rays that arrive from behind miss
SCREE_HD inline float hit_triangle(const Ray& ray, const Vec3f& a, const Vec3f& edge1,
                                   const Vec3f& edge2, bool one_sided) {
  const Vec3f p = cross(ray.direction, edge2);
  const float det = dot(edge1, p);
  if (one_sided ? det <= 0.0f : det == 0.0f) return kMiss;
  const float inv = 1.0f / det;
  const Vec3f s = ray.origin - a;
  const float u = dot(s, p) * inv;
  const Vec3f q = cross(s, edge1);
  const float v = dot(ray.direction, q) * inv;
  // Neighbors overlap by a hair, so that rounding leaves no pinholes along shared edges.
  constexpr float kOverlap = 1e-5f;
  if (!(u >= -kOverlap && v >= -kOverlap && u + v <= 1.0f + kOverlap)) return kMiss;
  return dot(edge2, q) * inv;
}

}  // namespace scree::render
