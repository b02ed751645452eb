#include "dynamics/affine/surface.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "solvers/solver.h"

namespace scree::affine {

Surface make_surface(const TriangleMesh& mesh, const Vec3d& center) {
  Surface s;
  for (const Vec3d& v : mesh.vertices) {
    s.vertices.push_back(v - center);
    s.radius = std::max(s.radius, norm(s.vertices.back()));
  }
  s.points.resize(s.vertices.size());
  std::iota(s.points.begin(), s.points.end(), 0);
  s.triangles = mesh.triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      if (a < 0 || static_cast<std::size_t>(a) >= mesh.vertices.size())
        throw InvalidParameter(mesh.name + ": triangle " + std::to_string(t) + " has vertex " +
                               std::to_string(a) + ", but there are " +
                               std::to_string(mesh.vertices.size()));
      s.edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(s.edges.begin(), s.edges.end());
  s.edges.erase(std::unique(s.edges.begin(), s.edges.end()), s.edges.end());
  return s;
}

}  // namespace scree::affine
