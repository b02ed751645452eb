#include "host/io/wall_surfaces.h"

#include <algorithm>
#include <utility>

namespace scree {
namespace {

/// Corner i has the sign of axis k in bit k. Faces in the order -x +x -y +y -z +z, outward.
Surface box(const Vec3d& half, unsigned open_faces) {
  constexpr std::array<std::array<int, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  Surface surface;
  for (int corner = 0; corner < 8; ++corner)
    surface.vertices.push_back(hadamard(
        half, Vec3d{corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0}));
  for (std::size_t face = 0; face < faces.size(); ++face)
    if ((open_faces >> face & 1u) == 0)
      surface.faces.emplace_back(faces[face].begin(), faces[face].end());
  return surface;
}

Surface sphere(double radius) {
  // An octahedron refined twice: enough to see where it is.
  Surface s;
  s.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  s.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
             {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < 2; ++level) {
    std::vector<std::vector<int>> finer;
    for (const std::vector<int>& f : s.faces) {
      const int first = static_cast<int>(s.vertices.size());
      for (std::size_t k = 0; k < 3; ++k)
        s.vertices.push_back(normalized(s.vertices[static_cast<std::size_t>(f[k])] +
                                        s.vertices[static_cast<std::size_t>(f[(k + 1) % 3])]));
      finer.push_back({f[0], first, first + 2});
      finer.push_back({f[1], first + 1, first});
      finer.push_back({f[2], first + 2, first + 1});
      finer.push_back({first, first + 1, first + 2});
    }
    s.faces = std::move(finer);
  }
  for (Vec3d& v : s.vertices) v *= radius;
  return s;
}

Surface square(const Vec3d& normal, double half_edge) {
  const Vec3d a = any_orthogonal(normal) * half_edge;
  const Vec3d b = cross(normal, a);
  return {{-a - b, a - b, a + b, b - a}, {{0, 1, 2, 3}}};
}

Surface mesh_surface(const TriangleMesh& mesh) {
  Surface surface{mesh.vertices, {}};
  for (const std::array<int, 3>& t : mesh.triangles) surface.faces.emplace_back(t.begin(), t.end());
  return surface;
}

Surface surface_of(const Scene& scene, const Shape& shape, double scene_size) {
  switch (shape.kind) {
    case Shape::Kind::sphere:
      return sphere(shape.radius);
    case Shape::Kind::box:
      return box(shape.half_extents, 0);
    case Shape::Kind::container:
      return box(shape.half_extents, shape.open_faces);
    case Shape::Kind::half_space:
      return square(shape.normal, scene_size);
    case Shape::Kind::mesh:
      return mesh_surface(scene.meshes.at(static_cast<std::size_t>(shape.mesh)));
  }
  return {};
}

/// Half edge for half spaces: reaches past every body from wherever the half space was put.
double size_of(const Scene& scene) {
  Vec3d low, high;
  double extent = 0;
  const auto reach = [&](const Vec3d& position) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], position[k]);
      high[k] = std::max(high[k], position[k]);
    }
  };
  for (const ParticleSet& set : scene.particles) {
    for (std::size_t i = 0; i < set.position.size(); ++i) {
      reach(set.position[i]);
      extent = std::max(extent, set.radius[i]);
    }
  }
  for (const BodyDescription& body : scene.bodies) {
    reach(body.position);
    extent = std::max({extent, body.shape.radius, norm(body.shape.half_extents)});
    if (body.shape.mesh >= 0)
      for (const Vec3d& v : scene.meshes.at(static_cast<std::size_t>(body.shape.mesh)).vertices)
        extent = std::max(extent, norm(v));
  }
  return norm(high - low) + extent;
}

}  // namespace

std::vector<WallSurface> wall_surfaces(const Scene& scene) {
  std::vector<WallSurface> walls;
  const double scene_size = size_of(scene);
  for (std::size_t id = 0; id < scene.bodies.size(); ++id) {
    const BodyDescription& body = scene.bodies[id];
    if (body.kind == BodyKind::free) continue;
    walls.push_back({id, surface_of(scene, body.shape, scene_size)});
  }
  return walls;
}

}  // namespace scree
