#pragma once
// A box of tetrahedra, six in each of its cells.

#include <array>

#include "host/scene/free_mesh.h"
#include "host/scene/tetrahedra.h"

namespace scree::test {

/// @param edges  full lengths [m]; the box is about the origin
inline TriangleMesh tetrahedra_box(const Vec3d& edges, const std::array<int, 3>& cells) {
  std::vector<Vec3d> vertices;
  const auto number = [&](int i, int j, int k) {
    return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i;
  };
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i)
        vertices.push_back({edges.x * (double(i) / cells[0] - 0.5),
                            edges.y * (double(j) / cells[1] - 0.5),
                            edges.z * (double(k) / cells[2] - 0.5)});
  // From the lower corner of a cell to the upper one, along the axes in each of their orders.
  constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<std::array<int, 4>> tetrahedra;
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        for (const auto& order : orders) {
          std::array<int, 3> at{i, j, k};
          std::array<int, 4> corners{number(i, j, k), 0, 0, 0};
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(order[step])];
            corners[step + 1] = number(at[0], at[1], at[2]);
          }
          tetrahedra.push_back(corners);
        }
      }
    }
  }
  return mesh_of_tetrahedra("box", vertices, tetrahedra);
}

/// Adds an elastic box. @return it
inline BodyDescription& add_elastic_box(Scene& scene, const Vec3d& position, const Vec3d& edges,
                                        const std::array<int, 3>& cells, double density,
                                        const Elasticity& elasticity) {
  BodyDescription body;
  body.position = position;
  set_free_mesh(scene, body, tetrahedra_box(edges, cells));
  set_mass_from_density(body, density);
  body.elastic = elasticity;
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

}  // namespace scree::test
