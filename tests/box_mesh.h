#pragma once
// A closed box of 12 triangles.

#include "kernels/math/vec3.h"
#include "shapes/shape.h"

namespace scree::test {

inline TriangleMesh box_mesh(const Vec3<double>& half, const Vec3<double>& at = {}) {
  TriangleMesh m;
  for (int k = 0; k < 8; ++k)
    m.vertices.push_back(at + Vec3<double>{(k & 1) != 0 ? half.x : -half.x,
                                           (k & 2) != 0 ? half.y : -half.y,
                                           (k & 4) != 0 ? half.z : -half.z});
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

}  // namespace scree::test
