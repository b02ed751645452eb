#pragma once
// The shape of one body as plain data. What a shape is stands in a file of its own beside this one.

#include <array>
#include <string>
#include <vector>

#include "kernels/math/quat.h"
#include "kernels/math/vec3.h"
#include "shapes/shape_kind.h"

namespace scree {

using Vec3d = Vec3<double>;

/// The shape of one body.
struct Shape {
  ShapeKind kind = kNoShape;
  double radius = 0;   ///< sphere [m]
  Vec3d half_extents;  ///< half edge lengths of the box about it, body frame [m]; not of a sphere
  /// half_space: unit outward normal in the body frame (bodies are on this side).
  Vec3d normal{0, 0, 1};
  unsigned open_faces = 0;  ///< container: bit 0..5 = -x +x -y +y -z +z face missing
  int mesh = -1;            ///< mesh, hull, compound, rounded hull: index into Scene::meshes
  /// Hull, compound, rounded, free mesh: what its mass is the density times of [m^3].
  double volume = 0;
  Vec3d moments;                  ///< of the same: principal moments of a unit mass [m^2]
  Rounding<double> rounded = {};  ///< rounded: of which core, see shapes::Rounded::of()
};

/// Half extents of the box about a shape before it was rounded, from the center of that [m].
inline Vec3d core_half_extents(const Shape& shape) {
  const double r = shape.rounded.radius;
  return shape.half_extents - Vec3d{r, r, r + shape.rounded.shift};
}

/// A part of a compound.
struct ShapePart {
  Shape shape;               ///< of a body that may be free, not itself a compound
  Vec3d position;            ///< of its center, in the frame of the compound [m]
  Quat<double> orientation;  ///< part to compound
  int first_vertex = 0;      ///< of its surface, or its core as a rounded hull, in the mesh
  int vertex_count = 0;
};

/// A closed (or declared open) triangle surface in its body's frame.
struct TriangleMesh {
  std::string name;                           ///< file it came from, for messages
  std::vector<Vec3d> vertices;                ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
  bool closed = true;
  std::vector<ShapePart> parts =
      {};  ///< of a compound: the mesh is their surfaces, one after the other
  /// Of a file with tetrahedra: what is inside. Their corners are vertices, and behind these the inner ones [m].
  std::vector<Vec3d> inner = {};
  std::vector<std::array<int, 4>> tetrahedra = {};  ///< of positive volume
};

}  // namespace scree
