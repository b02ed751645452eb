#pragma once
// What is drawn: every body, and every triangle of every body that carries a mesh, is one
// primitive. Primitive numbers: first the bodies (free ones, then fixed ones), then the triangles
// of all mesh bodies in the order of their shape records.

#include "kernels/bodies/body_view.h"
#include "kernels/render/view.h"
#include "shapes/shape_list.h"

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
  BodyRanges bodies;  ///< without ghosts
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

  SCREE_HD Index body_count() const { return bodies.present_count(); }
  SCREE_HD Index primitive_count() const { return body_count() + triangle_count; }
  SCREE_HD bool is_present(Index body) const { return body >= 0 && bodies.exists(body); }
};

/// Whether a shape is part of the background: it takes the color of that, casts no shadow and
/// hides nothing in front of what it holds.
template <class S>
constexpr bool is_backdrop_shape() {
  if constexpr (requires { S::is_backdrop; }) return S::is_backdrop;
  return false;
}
SCREE_HD inline bool is_backdrop(ShapeKind kind) {
  bool is_one = false;
  ShapeList::visit(kind, [&](auto shape) { is_one = is_backdrop_shape<decltype(shape)>(); });
  return is_one;
}
SCREE_HD inline Outline outline_of(ShapeKind kind) {
  Outline outline = Outline::plane;
  ShapeList::visit(kind, [&](auto shape) { outline = decltype(shape)::outline; });
  return outline;
}
/// A box seen from inside, such as a container.
SCREE_HD inline bool is_room(ShapeKind kind) {
  return is_backdrop(kind) && outline_of(kind) == Outline::box;
}

/// One primitive in its own frame, with the eye in that frame: ready to be intersected.
struct Solid {
  ShapeKind kind = kNoShape;  ///< none: not drawn in this view
  bool one_sided = false;     ///< triangle: seen from outside only
  unsigned open_faces = 0;    ///< container
  Index body = -1;            ///< storage index
  Eye eye;
  float radius = 0;    ///< sphere [m]
  Vec3f half_extents;  ///< of the box about it, or about its core [m]
  Vec3f normal;        ///< half-space: unit
  Vec3f vertex;        ///< triangle: first vertex [m]
  Vec3f edge1;         ///< triangle: to the second vertex [m]
  Vec3f edge2;         ///< triangle: to the third vertex [m]
  Hull hull;           ///< of a hull, or one that is rounded
  Rounding<float> rounded;

  /// Half extents of the box about all of it [m].
  SCREE_HD Vec3f reach() const {
    const float more = rounded.reach();
    return half_extents + Vec3f{more, more, more};
  }
  /// Drawn samples the solid may cover.
  SCREE_HD SampleRect rect(const View& view) const {
    if (kind == kNoShape) return {};
    switch (outline_of(kind)) {
      case Outline::ball:
        return sphere_rect(view, eye.to_view({0, 0, 0}), radius);
      case Outline::box:
        return box_rect(view, eye, reach());
      case Outline::plane:
        return drawn_rect(view);
      case Outline::triangles: {
        const Vec3f a = eye.to_view(vertex);
        const Vec3f b = eye.to_view(vertex + edge1);
        const Vec3f c = eye.to_view(vertex + edge2);
        PlaneBounds bounds;
        bounds.add_edge(view, a, b);
        bounds.add_edge(view, b, c);
        bounds.add_edge(view, c, a);
        return bounds.samples(view);
      }
    }
    return {};
  }

  /// Unit normal at a hit, towards the eye, in the solid's frame.
  SCREE_HD Vec3f normal_at(const Ray& ray, float depth) const {
    Vec3f n{0, 0, 1};
    ShapeList::visit(kind, [&](auto shape) { n = decltype(shape)::normal_at(*this, ray, depth); });
    return n;
  }
};

/// A fixed plate (at least six times wider than thick) that stands between the eye and the focus is
/// a front wall: like that of a container it is drawn by its edges only.
template <class Real>
SCREE_HD bool is_front_wall(const DrawList<Real>& list, Index body,
                            const ShapeRecord<Real>& record) {
  if (!list.bodies.is_fixed(body) || is_backdrop(record.kind)) return false;
  const Vec3f h(record.reach());
  const int axis = h.x < h.y ? (h.x < h.z ? 0 : 2) : (h.y < h.z ? 1 : 2);
  const float width = smaller(h[(axis + 1) % 3], h[(axis + 2) % 3]);
  if (!(h[axis] > 0.0f) || width < 6.0f * h[axis]) return false;
  Vec3f local;
  local[axis] = 1.0f;
  const Vec3<double> normal(rotate(Quat<float>(list.orientation[body]), local));
  const double eye_side = dot(list.eye - list.position[body], normal);
  const double focus_side = dot(list.focus - list.position[body], normal);
  return eye_side * focus_side < 0.0;
}

/// Primitive number to solid.
/// @param solid_only  leave out what is part of the background: it casts no shadow
template <class Real>
SCREE_HD Solid resolve(const DrawList<Real>& list, const View& view, Index primitive,
                       bool solid_only) {
  Solid solid;
  if (primitive < list.body_count()) {
    const Index body = list.bodies.present(primitive);
    solid.body = body;
    const Index shape = list.shape[body];
    if (shape < 0) {
      solid.radius = static_cast<float>(list.radius[body]);
      if (!(solid.radius > 0.0f)) return solid;
      solid.kind = shapes::Sphere::kind;
      solid.eye = view.eye_at(list.position[body]);
      return solid;
    }
    const ShapeRecord<Real>& record = list.shapes[shape];
    const Outline outline = outline_of(record.kind);
    if (outline == Outline::triangles) return solid;  // drawn triangle by triangle
    solid.half_extents = Vec3f(record.half_extents);
    solid.normal = Vec3f(record.normal);
    solid.open_faces = record.open_faces;
    solid.rounded = {record.rounded.core, static_cast<float>(record.rounded.radius),
                     static_cast<float>(record.rounded.shift)};
    if (shapes::has_hull(record))
      solid.hull = list.meshes.hulls.hull(record.mesh, static_cast<double>(record.half_extents.x));
    if (is_backdrop(record.kind) ? !solid_only : !is_front_wall(list, body, record)) {
      solid.kind = record.kind;
    }
    if (outline == Outline::ball) {
      solid.radius = static_cast<float>(list.radius[body]);
      solid.eye = view.eye_at(list.position[body]);
    } else {
      solid.eye = view.eye_at(list.position[body], list.orientation[body]);
    }
    return solid;
  }
  const Index k = primitive - list.body_count();
  const Index shape = owner_of(list.triangle_begin, k);
  const ShapeRecord<Real>& record = list.shapes[shape];
  const Index triangle = list.meshes.ranges[record.mesh].first_triangle +
                         static_cast<Index>(k - list.triangle_begin[shape]);
  const TriangleIndices& t = list.meshes.triangles[triangle];
  solid.kind = record.kind;
  solid.body = record.body;
  solid.one_sided = list.bodies.is_fixed(record.body);
  solid.vertex = Vec3f(list.meshes.vertices[t.v[0]]);
  solid.edge1 = Vec3f(list.meshes.vertices[t.v[1]]) - solid.vertex;
  solid.edge2 = Vec3f(list.meshes.vertices[t.v[2]]) - solid.vertex;
  solid.eye = view.eye_at(list.position[solid.body], list.orientation[solid.body]);
  return solid;
}

}  // namespace scree::render
