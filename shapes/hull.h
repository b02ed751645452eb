#pragma once
// The convex hull of points. Its mesh holds it in some size, the half extents those of the box about the origin that holds
// it: so bodies of many sizes share one mesh. A free body has its center of mass and its principal axes as frame.

#include <algorithm>

#include "kernels/bodies/hull.h"
#include "shapes/polyhedron.h"
#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

struct Hull {
  static constexpr ShapeKind kind{7};
  static constexpr const char* name = "hull";
  static constexpr const char* description = "the convex hull of points";
  static constexpr bool is_hull = true;
  static constexpr ShapeKey keys[]{
      {"points", ShapeKey::Type::points, "four points or more [m], or else a file."},
      {"file", ShapeKey::Type::file, ".stl or .obj file, relative to the scene file."},
      {"scale", ShapeKey::Type::scale,
       "the file's coordinates are multiplied by this [m per unit of the file]."},
      kRoundingKey};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) { source.read_hull(shape); }
  static std::optional<Fault> fault(const Shape& shape) {
    return lengths_fault("half_extents", shape.half_extents);
  }
  /// What a shape is that has a mesh in its own size. Its moments are those about its axes.
  static void measure(const TriangleMesh& mesh, Shape& shape) {
    const SolidMoments solid = moments_of(mesh);
    shape.kind = kind;
    shape.half_extents = box_about(mesh);
    shape.volume = solid.volume;
    shape.moments = solid.principal_moments();
  }
  /// Size of the body over that of its mesh.
  static double scale(const Shape& shape, const TriangleMesh& mesh) {
    return shape.half_extents.x / box_about(mesh).x;
  }
  static double bounding_radius(const Shape& shape, const TriangleMesh* mesh) {
    double largest = 0;
    for (const Vec3d& v : mesh->vertices) largest = std::max(largest, norm2(v));
    return scale(shape, *mesh) * std::sqrt(largest);
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
    return scale(shape, *mesh) * *std::max_element(mesh->vertices.begin(), mesh->vertices.end(),
                                                   [&](const Vec3d& a, const Vec3d& b) {
                                                     return dot(a, direction) < dot(b, direction);
                                                   });
  }
  static Chord chord(const Shape& shape, const TriangleMesh* mesh, const Vec3d& x, const Vec3d& d) {
    const double size = scale(shape, *mesh);
    Chord c;
    for (const std::array<int, 3>& t : mesh->triangles) {
      const auto corner = [&](std::size_t k) {
        return mesh->vertices[static_cast<std::size_t>(t[k])];
      };
      const Vec3d n = cross(corner(1) - corner(0), corner(2) - corner(0));
      c.cut_above(dot(n, x - size * corner(0)), dot(n, d));
    }
    return c;
  }
  static Surface surface(const Shape& shape, const TriangleMesh* mesh, double) {
    Surface surface{mesh->vertices, {}};
    for (Vec3d& v : surface.vertices) v *= scale(shape, *mesh);
    for (const std::array<int, 3>& t : mesh->triangles)
      surface.faces.emplace_back(t.begin(), t.end());
    return surface;
  }

  static constexpr Outline outline = Outline::box;
  /// Where a ray is inside of all planes, and the face by which it enters.
  struct Entry {
    float enter = -1e30f, leave = 1e30f;
    std::uint32_t face = 0;
  };
  template <class M>
  SCREE_HD static Entry entry(const M& m, const Ray& ray) {
    Entry e;
    for (std::uint32_t f = 0; f < m.hull.face_count; ++f) {
      const Vec3f n(m.hull.face[f].normal);
      const float against = dot(n, ray.direction);
      const auto height = static_cast<float>(m.hull.scale * m.hull.face[f].height);
      const float above = height - dot(n, ray.origin);
      if (std::abs(against) < kTiny) {
        if (above < 0.0f) e.leave = -1e30f;
        continue;
      }
      const float t = above / against;
      if (against < 0.0f) {
        if (t > e.enter) {
          e.enter = t;
          e.face = f;
        }
      } else if (t < e.leave) {
        e.leave = t;
      }
    }
    return e;
  }
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const Entry e = entry(m, ray);
    return e.enter <= e.leave ? e.enter : kMiss;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float) {
    return Vec3f(m.hull.face[entry(m, ray).face].normal);
  }
};

/// Whether a record of a shape is that of a hull, rounded or not.
template <class R>
SCREE_HD bool has_hull(const R& record) {
  return record.kind == Hull::kind || record.rounded.core == Hull::kind;
}

}  // namespace scree::shapes
