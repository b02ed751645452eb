#pragma once
// What is drawn: every body, and every triangle of every body that carries a mesh, is one
// primitive. Primitive numbers: first the bodies (free ones, then fixed ones), then the triangles
// of all mesh bodies in the order of their shape records.

#include "kernels/bodies/body_view.h"
#include "kernels/render/intersect.h"

namespace scree::render {

/// First index k with begin[k + 1] > item: the owner of `item` in a list of scanned counts.
SCREE_HD inline Index owner_of(Span<const Offset> begin, Offset item) {
  Index low = 0;
  Index high = static_cast<Index>(begin.size) - 2;
  while (low < high) {
    const Index middle = low + (high - low) / 2;
    if (begin[middle + 1] > item) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

/// The fields of the bodies that decide how they look.
template <class Real>
struct DrawList {
  Index free_count = 0;
  Index fixed_begin = 0;
  Index count = 0;
  Span<const Vec3<double>> position;
  Span<const Quat<Real>> orientation;
  PerBody<Real> radius;
  PerBody<Index> shape;
  Span<const ShapeRecord<Real>> shapes;
  MeshSetView<Real> meshes;
  /// [shapes + 1] scanned triangle counts; empty without meshes.
  Span<const Offset> triangle_begin;
  Index triangle_count = 0;  ///< of all mesh bodies
  Vec3<double> eye;          ///< position of the camera [m]
  Vec3<double> focus;        ///< center of the free bodies [m]: walls between the two are not drawn

  SCREE_HD Index body_count() const { return free_count + (count - fixed_begin); }
  SCREE_HD Index primitive_count() const { return body_count() + triangle_count; }
  SCREE_HD Index body_of_slot(Index slot) const {
    return slot < free_count ? slot : fixed_begin + (slot - free_count);
  }
  SCREE_HD bool is_present(Index body) const {
    return (body >= 0 && body < free_count) || (body >= fixed_begin && body < count);
  }
};

enum class SolidKind : std::uint8_t { none, sphere, box, half_space, container, triangle };

/// One primitive in its own frame, with the eye in that frame: ready to be intersected.
struct Solid {
  SolidKind kind = SolidKind::none;  ///< none: not drawn in this view
  bool one_sided = false;            ///< triangle: seen from outside only
  unsigned open_faces = 0;           ///< container
  Index body = -1;                   ///< storage index
  Eye eye;
  float radius = 0;    ///< sphere [m]
  Vec3f half_extents;  ///< box, container [m]
  Vec3f normal;        ///< half-space: unit
  Vec3f vertex;        ///< triangle: first vertex [m]
  Vec3f edge1;         ///< triangle: to the second vertex [m]
  Vec3f edge2;         ///< triangle: to the third vertex [m]

  /// Depth at which a ray hits, or kMiss. @tparam known  the solid's kind
  template <SolidKind known>
  SCREE_HD float hit(const Ray& ray) const {
    if constexpr (known == SolidKind::sphere) return hit_sphere(ray, radius);
    if constexpr (known == SolidKind::box) return hit_box(ray, half_extents);
    if constexpr (known == SolidKind::half_space) return hit_plane(ray, normal);
    if constexpr (known == SolidKind::container)
      return hit_container(ray, half_extents, open_faces);
    if constexpr (known == SolidKind::triangle)
      return hit_triangle(ray, vertex, edge1, edge2, one_sided);
    return kMiss;
  }

  /// Drawn samples the solid may cover.
  SCREE_HD SampleRect rect(const View& view) const {
    switch (kind) {
      case SolidKind::sphere:
        return sphere_rect(view, eye.to_view({0, 0, 0}), radius);
      case SolidKind::box:
      case SolidKind::container:
        return box_rect(view, eye, half_extents);
      case SolidKind::half_space:
        return drawn_rect(view);
      case SolidKind::triangle: {
        const Vec3f a = eye.to_view(vertex);
        const Vec3f b = eye.to_view(vertex + edge1);
        const Vec3f c = eye.to_view(vertex + edge2);
        PlaneBounds bounds;
        bounds.add_edge(view, a, b);
        bounds.add_edge(view, b, c);
        bounds.add_edge(view, c, a);
        return bounds.samples(view);
      }
      case SolidKind::none:
        break;
    }
    return {};
  }

  /// Unit normal at a hit, towards the eye, in the solid's frame.
  SCREE_HD Vec3f normal_at(const Ray& ray, float depth) const {
    Vec3f n{0, 0, 1};
    switch (kind) {
      case SolidKind::sphere:
        n = (1.0f / radius) * (ray.origin + depth * ray.direction);
        break;
      case SolidKind::box:
      case SolidKind::container: {
        const BoxSpan span = span_in_box(ray, half_extents);
        const int axis = kind == SolidKind::box ? span.enter_axis : span.leave_axis;
        n = {0, 0, 0};
        n[axis] = ray.direction[axis] > 0.0f ? -1.0f : 1.0f;
        break;
      }
      case SolidKind::half_space:
        n = normal;
        break;
      case SolidKind::triangle: {
        n = normalized(cross(edge1, edge2));
        if (dot(n, ray.direction) > 0.0f) n = -n;
        break;
      }
      case SolidKind::none:
        break;
    }
    return n;
  }
};

/// A fixed plate (a box at least six times wider than thick) that stands between the eye and the
/// focus is a front wall: like that of a container it is drawn by its edges only.
template <class Real>
SCREE_HD bool is_front_wall(const DrawList<Real>& list, Index body,
                            const ShapeRecord<Real>& record) {
  if (body < list.fixed_begin || record.kind != ShapeKind::box) return false;
  const Vec3f h(record.half_extents);
  const int axis = h.x < h.y ? (h.x < h.z ? 0 : 2) : (h.y < h.z ? 1 : 2);
  const float width = smaller(h[(axis + 1) % 3], h[(axis + 2) % 3]);
  if (width < 6.0f * h[axis]) return false;
  Vec3f local;
  local[axis] = 1.0f;
  const Vec3<double> normal(rotate(Quat<float>(list.orientation[body]), local));
  const double eye_side = dot(list.eye - list.position[body], normal);
  const double focus_side = dot(list.focus - list.position[body], normal);
  return eye_side * focus_side < 0.0;
}

/// Primitive number to solid.
/// @param solid_only  leave out half-spaces and containers, which cast no shadow
template <class Real>
SCREE_HD Solid resolve(const DrawList<Real>& list, const View& view, Index primitive,
                       bool solid_only) {
  Solid solid;
  if (primitive < list.body_count()) {
    const Index body = list.body_of_slot(primitive);
    solid.body = body;
    const Index shape = list.shape[body];
    if (shape < 0) {
      solid.radius = static_cast<float>(list.radius[body]);
      if (!(solid.radius > 0.0f)) return solid;
      solid.kind = SolidKind::sphere;
      solid.eye = view.eye_at(list.position[body]);
      return solid;
    }
    const ShapeRecord<Real>& record = list.shapes[shape];
    solid.half_extents = Vec3f(record.half_extents);
    switch (record.kind) {
      case ShapeKind::sphere:
        solid.kind = SolidKind::sphere;
        solid.radius = static_cast<float>(list.radius[body]);
        solid.eye = view.eye_at(list.position[body]);
        return solid;
      case ShapeKind::box:
        if (!is_front_wall(list, body, record)) solid.kind = SolidKind::box;
        break;
      case ShapeKind::half_space:
        if (!solid_only) solid.kind = SolidKind::half_space;
        solid.normal = Vec3f(record.normal);
        break;
      case ShapeKind::container:
        if (!solid_only) solid.kind = SolidKind::container;
        solid.open_faces = record.open_faces;
        break;
      case ShapeKind::mesh:
        return solid;  // drawn triangle by triangle
    }
    solid.eye = view.eye_at(list.position[body], list.orientation[body]);
    return solid;
  }
  const Index k = primitive - list.body_count();
  const Index shape = owner_of(list.triangle_begin, k);
  const ShapeRecord<Real>& record = list.shapes[shape];
  const Index triangle = list.meshes.ranges[record.mesh].first_triangle +
                         static_cast<Index>(k - list.triangle_begin[shape]);
  const TriangleIndices& t = list.meshes.triangles[triangle];
  solid.kind = SolidKind::triangle;
  solid.body = record.body;
  solid.one_sided = record.body >= list.fixed_begin;
  solid.vertex = Vec3f(list.meshes.vertices[t.v[0]]);
  solid.edge1 = Vec3f(list.meshes.vertices[t.v[1]]) - solid.vertex;
  solid.edge2 = Vec3f(list.meshes.vertices[t.v[2]]) - solid.vertex;
  solid.eye = view.eye_at(list.position[solid.body], list.orientation[solid.body]);
  return solid;
}

}  // namespace scree::render
