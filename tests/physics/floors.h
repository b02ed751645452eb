#pragma once
// Floors of every kind at z = 0.

#include <vector>

#include "host/hulls.h"
#include "shapes/rounded.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {

inline std::vector<Vec3d> box_points(const Vec3d& half) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 8; ++k)
    points.push_back(
        {k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
  return points;
}

enum class Floor { plane, box, mesh, hull, rounded_box };

/// @param half  width of those that end [m]
inline void add_floor(Scene& scene, Floor floor, double half) {
  if (floor == Floor::plane) add_plane(scene);
  if (floor == Floor::box) add_wall_box(scene, {0, 0, -1}, {half, half, 1});
  if (floor == Floor::mesh) {
    const double m = half + 0.1;
    TriangleMesh mesh;
    mesh.name = "square";
    mesh.closed = false;
    mesh.vertices = {{-m, -m, 0}, {m, -m, 0}, {m, m, 0}, {-m, m, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    add_mesh(scene, mesh);
  }
  if (floor == Floor::hull) {
    BodyDescription body;
    body.kind = BodyKind::fixed;
    body.position = {0, 0, -1};
    set_hull(scene, body, box_points({half, half, 1}));
    scene.bodies.push_back(body);
  }
  if (floor == Floor::rounded_box) {
    BodyDescription body;
    body.kind = BodyKind::fixed;
    body.position = {0, 0, -1};
    body.shape.kind = shapes::Box::kind;
    body.shape.half_extents = {half, half, 0.75};
    body.shape = shapes::Rounded::of(body.shape, 0.25);
    scene.bodies.push_back(body);
  }
}

}  // namespace scree::physics
