#pragma once
// A solid box about the center of its body, its edges along the body axes.

#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

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

/// Normal of the side of a box across an axis, against the ray.
SCREE_HD inline Vec3f side_normal(const Ray& ray, int axis) {
  Vec3f n{0, 0, 0};
  n[axis] = ray.direction[axis] > 0.0f ? -1.0f : 1.0f;
  return n;
}

struct Box {
  static constexpr ShapeKind kind{1};
  static constexpr const char* name = "box";
  static constexpr const char* description = "a solid box";
  static constexpr ShapeKey keys[]{
      {"size", ShapeKey::Type::vector, "full edge lengths [m], positive.", true}, kRoundingKey};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) {
    shape.half_extents = 0.5 * source.edges("size");
  }
  static std::optional<Fault> fault(const Shape& shape) {
    return lengths_fault("half_extents", shape.half_extents);
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh*) {
    return norm(shape.half_extents);
  }
  static MassProperties mass(const Shape& shape, double density) {
    const Vec3d& e = shape.half_extents;
    const double mass = density * 8 * e.x * e.y * e.z;
    const Vec3d square = hadamard(e, e);
    return {mass, mass / 3 * Vec3d{square.y + square.z, square.z + square.x, square.x + square.y}};
  }
  static Vec3d farthest(const Shape& shape, const TriangleMesh*, const Vec3d& direction) {
    const Vec3d& e = shape.half_extents;
    return {direction.x < 0 ? -e.x : e.x, direction.y < 0 ? -e.y : e.y,
            direction.z < 0 ? -e.z : e.z};
  }
  static Chord chord(const Shape& shape, const TriangleMesh*, const Vec3d& x, const Vec3d& d) {
    Chord c;
    for (int k = 0; k < 3; ++k) c.cut_slab(x[k], d[k], shape.half_extents[k]);
    return c;
  }
  static Surface surface(const Shape& shape, const TriangleMesh*, double) {
    return box_surface(shape.half_extents, 0);
  }

  /// Point of it nearest to x, body frame [m].
  SCREE_HD static Vec3d nearest(const Vec3d& half_extents, const Vec3d& x) {
    Vec3d nearest = x;
    for (int k = 0; k < 3; ++k) {
      const double limit = half_extents[k];
      nearest[k] = x[k] > limit ? limit : x[k] < -limit ? -limit : x[k];
    }
    return nearest;
  }

  static constexpr Outline outline = Outline::box;
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const BoxSpan span = span_in_box(ray, m.half_extents);
    return span.enter <= span.leave ? span.enter : kMiss;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float) {
    return side_normal(ray, span_in_box(ray, m.half_extents).enter_axis);
  }
  /// Dark lines along the edges.
  template <class M>
  SCREE_HD static float paint(const M& m, const Vec3f& p, const Vec3f& n, float footprint) {
    const Vec3f& h = m.half_extents;
    float margin = 1e30f;
    for (int axis = 0; axis < 3; ++axis) {
      const float depth = h[axis] - std::abs(p[axis]);
      if (n[axis] == 0.0f) margin = margin < depth ? margin : depth;
    }
    const float least = h.y < h.z ? h.y : h.z;
    const float line = 0.06f * (h.x < least ? h.x : least);
    const float strength = smooth_step(0.7f, 2.5f, line / footprint);
    return 1.0f - 0.35f * strength * (1.0f - smooth_step(0.6f * line, 1.6f * line, margin));
  }
};

}  // namespace scree::shapes
