#pragma once
// A surface of triangles from a file.

#include <algorithm>
#include <cmath>

#include "shapes/polyhedron.h"
#include "shapes/ray.h"
#include "shapes/shape_card.h"

namespace scree::shapes {

struct Mesh {
  static constexpr ShapeKind kind{4};
  static constexpr const char* name = "mesh";
  static constexpr const char* description = "a triangle surface";
  static constexpr ShapeKey keys[]{
      {"file", ShapeKey::Type::file,
       ".stl or .obj file, or .msh or .vtk file of tetrahedra, relative to the scene file.", true},
      {"scale", ShapeKey::Type::scale,
       "the file's coordinates are multiplied by this [m per unit of the file]."},
      {"closed", ShapeKey::Type::flag,
       "the surface must be watertight. false: edges with one triangle are allowed."}};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) { source.read_mesh(shape); }
  /// Gives a shape what the mass of the solid inside needs. @param mesh  its center of mass is the
  /// origin, its axes are principal
  static void measure(const TriangleMesh& mesh, Shape& shape) {
    const SolidMoments solid = moments_about(mesh, {});
    shape.kind = kind;
    shape.half_extents = box_about(mesh);
    shape.volume = solid.volume;
    shape.moments = solid.principal_moments();
  }
  static MassProperties mass_inside(const Shape& shape, double density) {
    const double mass = density * shape.volume;
    return {mass, mass * shape.moments};
  }
  /// Its triangles are checked with the meshes of the scene.
  static std::optional<Fault> fault(const Shape&) { return std::nullopt; }
  static double bounding_radius(const Shape&, const TriangleMesh* mesh) {
    double largest = 0;
    for (const Vec3d& v : mesh->vertices) largest = std::max(largest, norm2(v));
    return std::sqrt(largest);
  }
  static Vec3d farthest(const Shape&, const TriangleMesh* mesh, const Vec3d& direction) {
    return *std::max_element(
        mesh->vertices.begin(), mesh->vertices.end(),
        [&](const Vec3d& a, const Vec3d& b) { return dot(a, direction) < dot(b, direction); });
  }
  static Surface surface(const Shape&, const TriangleMesh* mesh, double) {
    Surface surface{mesh->vertices, {}};
    for (const std::array<int, 3>& t : mesh->triangles)
      surface.faces.emplace_back(t.begin(), t.end());
    return surface;
  }

  static constexpr Outline outline = Outline::triangles;
  /// One triangle: vertex, vertex + edge1, vertex + edge2. Rays that arrive from behind miss it when
  /// it is one-sided.
  template <class M>
  SCREE_HD static float hit(const M& m, const Ray& ray) {
    const Vec3f p = cross(ray.direction, m.edge2);
    const float det = dot(m.edge1, p);
    if (m.one_sided ? det <= 0.0f : det == 0.0f) return kMiss;
    const float inv = 1.0f / det;
    const Vec3f s = ray.origin - m.vertex;
    const float u = dot(s, p) * inv;
    const Vec3f q = cross(s, m.edge1);
    const float v = dot(ray.direction, q) * inv;
    // Neighbors overlap by a hair, so that rounding leaves no pinholes along shared edges.
    constexpr float kOverlap = 1e-5f;
    if (!(u >= -kOverlap && v >= -kOverlap && u + v <= 1.0f + kOverlap)) return kMiss;
    return dot(m.edge2, q) * inv;
  }
  template <class M>
  SCREE_HD static Vec3f normal_at(const M& m, const Ray& ray, float) {
    const Vec3f n = normalized(cross(m.edge1, m.edge2));
    return dot(n, ray.direction) > 0.0f ? -n : n;
  }
};

}  // namespace scree::shapes
