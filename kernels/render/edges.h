#pragma once
// The edges of containers and front walls: thin lines that lie over the bodies behind them without
// hiding them. A buffer of marks tells which samples they cover.

#include "kernels/render/visibility.h"

namespace scree::render {

inline constexpr Index kBoxEdges = 12;

/// Edges of fixed bodies as primitives: number = 12 * (body - fixed_begin) + edge.
template <class Real>
struct EdgeSource {
  static constexpr const char* count_name = "render_count_edges";
  static constexpr const char* draw_name = "render_draw_edges";
  DrawList<Real> list;
  View view;
  Span<const std::uint64_t> samples;  ///< visibility buffer, finished
  Span<std::uint8_t> marks;           ///< [view.sample_count()] in and out: 1 where an edge is seen
  float half_width = 1;               ///< [samples]

  SCREE_HD Index primitive_count() const { return kBoxEdges * list.bodies.fixed_count(); }

  /// Ends of the visible part of an edge in view coordinates; false when there is nothing to draw.
  SCREE_HD bool segment(Index primitive, Vec3f& a, Vec3f& b) const {
    const Index body = list.bodies.fixed_begin + primitive / kBoxEdges;
    const Index shape = list.shape[body];
    if (shape < 0) return false;
    const ShapeRecord<Real>& record = list.shapes[shape];
    const bool is_container = is_room(record.kind);
    if (!is_container && !is_front_wall(list, body, record)) return false;

    // Edge k runs along one axis, at signs (s1, s2) of the next two.
    const int edge = primitive % kBoxEdges;
    const int axis = edge / 4, axis1 = (axis + 1) % 3, axis2 = (axis + 2) % 3;
    const int s1 = edge & 1, s2 = (edge >> 1) & 1;
    if (is_container) {
      const unsigned faces = (1u << (2 * axis1 + s1)) | (1u << (2 * axis2 + s2));
      if ((record.open_faces & faces) == faces) return false;
    }
    const Vec3f h(record.reach());
    Vec3f p;
    p[axis] = -h[axis];
    p[axis1] = s1 != 0 ? h[axis1] : -h[axis1];
    p[axis2] = s2 != 0 ? h[axis2] : -h[axis2];
    const Eye eye = view.eye_at(list.position[body], list.orientation[body]);
    a = eye.to_view(p);
    p[axis] = h[axis];
    b = eye.to_view(p);
    if (a.z < view.near_depth && b.z < view.near_depth) return false;
    const float near_depth = view.near_depth;
    if (a.z < near_depth) a = a + ((near_depth - a.z) / (b.z - a.z)) * (b - a), a.z = near_depth;
    if (b.z < near_depth) b = b + ((near_depth - b.z) / (a.z - b.z)) * (a - b), b.z = near_depth;
    return true;
  }

  SCREE_HD SampleRect rect(Index primitive) const {
    Vec3f a, b;
    if (!segment(primitive, a, b)) return {};
    PlaneBounds bounds;
    bounds.add_edge(view, a, b);
    return bounds.samples(view, half_width);
  }

  SCREE_HD void draw(Index primitive, Index chunk) const {
    Vec3f a, b;
    if (!segment(primitive, a, b)) return;
    PlaneBounds bounds;
    bounds.add_edge(view, a, b);
    const SampleRect area = bounds.samples(view, half_width).chunk(chunk);
    // Perspective views only: lines are drawn for the camera, never for the light.
    const Vec3f p{a.x / a.z, a.y / a.z, 0}, q{b.x / b.z, b.y / b.z, 0};
    const Vec3f along = q - p;
    const float length2 = larger(norm2(along), kTiny);
    const float reach = half_width * view.pitch;
    for (int j = area.y_begin; j < area.y_end; ++j) {
      for (int i = area.x_begin; i < area.x_end; ++i) {
        const Vec3f d = Vec3f{view.plane_x(i), view.plane_y(j), 0} - p;
        const float s = clamp(dot(d, along) / length2, 0.0f, 1.0f);
        if (norm2(d - s * along) > reach * reach) continue;
        const float depth = 1.0f / mix(1.0f / a.z, 1.0f / b.z, s);  // 1/z is linear on the screen
        // An edge of the wall that the sample sees is seen, too.
        const Offset at = view.index(i, j);
        if (depth < depth_of(samples[at]) * 1.002f) atomic_mark(marks.data + at);
      }
    }
  }
};

}  // namespace scree::render
