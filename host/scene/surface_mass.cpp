#include "host/scene/surface_mass.h"

#include <algorithm>
#include <array>

namespace scree {

std::vector<double> vertex_areas(const TriangleMesh& mesh) {
  std::vector<double> areas(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3d, 3> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = mesh.vertices[static_cast<std::size_t>(triangle[k])];
    const double area = norm(cross(x[1] - x[0], x[2] - x[0])) / 2;
    if (!(area > 0)) continue;
    std::array<double, 3> cosine{};  // dot of the edges at a corner
    for (std::size_t k = 0; k < 3; ++k)
      cosine[k] = dot(x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
    const auto obtuse = std::find_if(cosine.begin(), cosine.end(), [](double c) { return c < 0; });
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      double share = 0;
      if (obtuse != cosine.end())
        share = (&cosine[k] == &*obtuse ? 0.5 : 0.25) * area;
      else  // cot = dot over twice the area; each edge counts with the angle across
        share = (norm2(x[i] - x[k]) * cosine[j] + norm2(x[j] - x[k]) * cosine[i]) / (16 * area);
      areas[static_cast<std::size_t>(triangle[k])] += share;
    }
  }
  return areas;
}

Vec3d center_of_surface(const TriangleMesh& mesh) {
  const std::vector<double> areas = vertex_areas(mesh);
  const Vec3d origin = mesh.vertices.at(0);
  double whole = 0;
  Vec3d sum;
  for (std::size_t v = 0; v < areas.size(); ++v) {
    sum += areas[v] * (mesh.vertices[v] - origin);
    whole += areas[v];
  }
  return whole > 0 ? origin + (1 / whole) * sum : origin;
}

}  // namespace scree
