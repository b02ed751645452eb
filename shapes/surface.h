#pragma once
// Surfaces as files for viewers hold them.

#include <array>
#include <cstddef>
#include <vector>

#include "kernels/math/vec3.h"

namespace scree {

/// Corners [m] and faces of one body in its own frame; faces counter-clockwise seen from outside.
struct Surface {
  std::vector<Vec3<double>> vertices;
  std::vector<std::vector<int>> faces;
};

/// A box. Corner i has the sign of axis k in bit k. Faces in the order -x +x -y +y -z +z, outward.
/// @param open_faces  bits of the faces that are missing
inline Surface box_surface(const Vec3<double>& half, unsigned open_faces) {
  constexpr std::array<std::array<int, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  Surface surface;
  for (int corner = 0; corner < 8; ++corner)
    surface.vertices.push_back({corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                                corner & 4 ? half.z : -half.z});
  for (std::size_t face = 0; face < faces.size(); ++face)
    if ((open_faces >> face & 1u) == 0)
      surface.faces.emplace_back(faces[face].begin(), faces[face].end());
  return surface;
}

}  // namespace scree
