#pragma once
// Several shapes that move as one body. Its mesh holds them in some size, the half extents those of the box about the origin that
// holds them: so bodies of many sizes share one mesh. A free body has its center of mass and its principal axes as frame.
// Collision detection and pictures see the parts.

#include <algorithm>

#include "kernels/math/quat.h"
#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

struct Compound {
  static constexpr ShapeKind kind{10};
  static constexpr const char* name = "compound";
  static constexpr const char* description = "several shapes that move as one body";
  static constexpr bool is_compound = true;
  static constexpr ShapeKey keys[]{
      {"parts", ShapeKey::Type::parts, "shapes, each with its position and orientation.", true},
      {"overlaps", ShapeKey::Type::overlaps,
       "whether the mass of what parts have in common counts once, or for each of them."}};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) { source.read_compound(shape); }
  static std::optional<Fault> fault(const Shape& shape) {
    return lengths_fault("half_extents", shape.half_extents);
  }
  /// Farthest point of a part along a direction, frame of the compound [m].
  static Vec3d farthest_of(const TriangleMesh& mesh, const ShapePart& part,
                           const Vec3d& direction) {
    const ShapeCard& card = shape_card(part.shape.kind);
    if (!has_hull(part.shape))
      return part.position +
             rotate(part.orientation,
                    card.support(part.shape, nullptr, rotate_back(part.orientation, direction)));
    const auto first = mesh.vertices.begin() + part.first_vertex;
    const Vec3d corner = *std::max_element(
        first, first + part.vertex_count,
        [&](const Vec3d& a, const Vec3d& b) { return dot(a, direction) < dot(b, direction); });
    const double rounding = part.shape.rounded.radius;
    return rounding > 0 ? corner + rounding * normalized(direction) : corner;
  }
  /// Half extents of the box about the origin that holds the parts [m].
  static Vec3d box_about_parts(const TriangleMesh& mesh) {
    Vec3d half;
    for (const ShapePart& part : mesh.parts)
      for (int k = 0; k < 3; ++k)
        for (const double sign : {-1.0, 1.0}) {
          Vec3d direction;
          direction[k] = sign;
          half[k] = std::max(half[k], std::abs(farthest_of(mesh, part, direction)[k]));
        }
    return half;
  }
  /// Size of the body over that of its mesh.
  static double scale(const Shape& shape, const TriangleMesh& mesh) {
    return shape.half_extents.x / box_about_parts(mesh).x;
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh* mesh) {
    double largest = 0;
    for (const ShapePart& part : mesh->parts) {
      const ShapeCard& card = shape_card(part.shape.kind);
      double reach = 0;
      if (has_hull(part.shape)) {
        for (int v = part.first_vertex; v < part.first_vertex + part.vertex_count; ++v)
          reach = std::max(
              reach, norm(mesh->vertices[static_cast<std::size_t>(v)]) + part.shape.rounded.radius);
      } else {
        reach = norm(part.position) + card.bounding_radius(part.shape, nullptr);
      }
      largest = std::max(largest, reach);
    }
    return scale(shape, *mesh) * largest;
  }
  static MassProperties mass(const Shape& shape, double density) {
    const double mass = density * shape.volume;
    return {mass, mass * shape.moments};
  }
  static Shape scaled(const Shape& shape, double factor) {
    Shape out = shape;
    out.half_extents *= factor;
    out.volume *= factor * factor * factor;
    out.moments *= factor * factor;
    return out;
  }
  static Vec3d farthest(const Shape& shape, const TriangleMesh* mesh, const Vec3d& direction) {
    Vec3d best;
    double most = -1e300;
    for (const ShapePart& part : mesh->parts) {
      const Vec3d point = farthest_of(*mesh, part, direction);
      if (!(dot(point, direction) > most)) continue;
      most = dot(point, direction);
      best = point;
    }
    return scale(shape, *mesh) * best;
  }
  static Surface surface(const Shape& shape, const TriangleMesh* mesh, double) {
    Surface surface;
    int used = 0;  // corners of rounded hulls come last, without triangles
    for (const std::array<int, 3>& t : mesh->triangles) {
      surface.faces.emplace_back(t.begin(), t.end());
      for (const int v : t) used = std::max(used, v + 1);
    }
    surface.vertices.assign(mesh->vertices.begin(), mesh->vertices.begin() + used);
    for (Vec3d& v : surface.vertices) v *= scale(shape, *mesh);
    return surface;
  }

  // Pictures show its parts.
  static constexpr Outline outline = Outline::box;
  template <class M>
  SCREE_HD static float hit(const M&, const Ray&) {
    return kMiss;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M&, const Ray&, float) {
    return {0, 0, 1};
  }
};

}  // namespace scree::shapes
