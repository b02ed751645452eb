#pragma once
// The shape of one body as plain data. What a shape is stands in a file of its own beside this one.

#include <array>
#include <string>
#include <vector>

#include "kernels/math/vec3.h"
#include "shapes/shape_kind.h"

namespace scree {

using Vec3d = Vec3<double>;

/// A closed (or declared open) triangle surface in its body's frame.
struct TriangleMesh {
  std::string name;                           ///< file it came from, for messages
  std::vector<Vec3d> vertices;                ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
  bool closed = true;
};

/// The shape of one body.
struct Shape {
  ShapeKind kind = kNoShape;
  double radius = 0;   ///< sphere [m]
  Vec3d half_extents;  ///< half edge lengths of the box about it, body frame [m]; not of a sphere
  /// half_space: unit outward normal in the body frame (bodies are on this side).
  Vec3d normal{0, 0, 1};
  unsigned open_faces = 0;  ///< container: bit 0..5 = -x +x -y +y -z +z face missing
  int mesh = -1;            ///< mesh, hull: index into Scene::meshes
  double volume = 0;        ///< hull [m^3]
  Vec3d moments;            ///< hull: principal moments of a unit mass [m^2]
};

}  // namespace scree
