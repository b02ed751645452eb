#pragma once
// Volume of a closed mesh, by the tetrahedra of its triangles with the origin.

#include "kernels/math/vec3.h"
#include "shapes/shape.h"

namespace scree::test {

inline double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += dot(mesh.vertices.at(static_cast<std::size_t>(i)),
               cross(mesh.vertices.at(static_cast<std::size_t>(j)),
                     mesh.vertices.at(static_cast<std::size_t>(k))));
  return sum / 6;
}

}  // namespace scree::test
