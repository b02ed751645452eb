#include "host/scene/tetrahedra.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/scene/mesh_text.h"

namespace scree {
namespace {

using mesh_text::fail;
using Corners = std::array<int, 4>;

Vec3d corner(const std::vector<Vec3d>& vertices, int v) {
  return vertices[static_cast<std::size_t>(v)];
}

/// Turns tetrahedra that are inside out.
void turn_right(const std::string& name, const std::vector<Vec3d>& vertices,
                std::vector<Corners>& tetrahedra) {
  constexpr double kFlat = 1e-10;  // of the cube of the longest edge
  for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
    Corners& c = tetrahedra[t];
    double longest2 = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j)
        longest2 = std::max(longest2, norm2(corner(vertices, c[i]) - corner(vertices, c[j])));
    const Vec3d origin = corner(vertices, c[0]);
    const double volume6 =
        dot(corner(vertices, c[1]) - origin,
            cross(corner(vertices, c[2]) - origin, corner(vertices, c[3]) - origin));
    if (!(std::abs(volume6) > kFlat * longest2 * std::sqrt(longest2)))
      fail(name, fmt::format("tetrahedron {} is flat", t));
    if (volume6 < 0) std::swap(c[2], c[3]);
  }
}

/// Triangles of one tetrahedron alone, seen counter-clockwise from outside, in the order of the tetrahedra.
std::vector<std::array<int, 3>> surface_of(const std::string& name,
                                           const std::vector<Corners>& tetrahedra) {
  constexpr std::size_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  struct Face {
    std::array<int, 3> sorted, face;
    std::size_t place;
  };
  std::vector<Face> all;
  for (const Corners& c : tetrahedra) {
    for (const auto& f : faces) {
      const std::array<int, 3> face{c[f[0]], c[f[1]], c[f[2]]};
      std::array<int, 3> sorted = face;
      std::sort(sorted.begin(), sorted.end());
      all.push_back({sorted, face, all.size()});
    }
  }
  std::sort(all.begin(), all.end(), [](const Face& a, const Face& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.place < b.place;
  });
  std::vector<Face> once;
  for (std::size_t k = 0; k < all.size();) {
    std::size_t end = k;
    while (end < all.size() && all[end].sorted == all[k].sorted) ++end;
    if (end - k > 2)
      fail(name, fmt::format("tetrahedra {}, {} and {} have the same three corners",
                             all[k].place / 4, all[k + 1].place / 4, all[k + 2].place / 4));
    if (end - k == 1) once.push_back(all[k]);
    k = end;
  }
  std::sort(once.begin(), once.end(),
            [](const Face& a, const Face& b) { return a.place < b.place; });
  std::vector<std::array<int, 3>> triangles;
  triangles.reserve(once.size());
  for (const Face& f : once) triangles.push_back(f.face);
  return triangles;
}

}  // namespace

TriangleMesh mesh_of_tetrahedra(const std::string& name, const std::vector<Vec3d>& vertices,
                                std::vector<Corners> tetrahedra) {
  if (tetrahedra.empty()) fail(name, "holds no tetrahedra");
  turn_right(name, vertices, tetrahedra);
  TriangleMesh mesh;
  mesh.name = name;
  mesh.triangles = surface_of(name, tetrahedra);
  mesh.tetrahedra = std::move(tetrahedra);
  // Vertices of the surface come first, in the order of triangles; then inner ones, in the order of tetrahedra.
  std::vector<int> number(vertices.size(), -1);
  int count = 0;
  const auto renumber = [&](int& v, std::vector<Vec3d>& points) {
    int& n = number[static_cast<std::size_t>(v)];
    if (n < 0) {
      n = count++;
      points.push_back(corner(vertices, v));
    }
    v = n;
  };
  for (auto& triangle : mesh.triangles)
    for (int& v : triangle) renumber(v, mesh.vertices);
  for (auto& tetrahedron : mesh.tetrahedra)
    for (int& v : tetrahedron) renumber(v, mesh.inner);
  return mesh;
}

}  // namespace scree
