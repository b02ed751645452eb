#pragma once
// The surface of an affine body: what may touch.

#include <array>
#include <vector>

#include "kernels/affine/affine_state.h"

namespace scree::affine {

/// Corners in coordinates of the body, about its center of mass. Bodies may share one.
struct Surface {
  std::vector<Vec3d> vertices;            ///< [m]
  std::vector<int> points;                ///< vertices that touch triangles
  std::vector<std::array<int, 2>> edges;  ///< each once
  std::vector<std::array<int, 3>> triangles;
  double radius = 0;  ///< distance of the farthest corner from the center of mass [m]
};

/// @param center  of mass, in coordinates of the mesh [m]. @throws InvalidParameter naming the
/// triangle for an index that is no vertex
Surface make_surface(const TriangleMesh& mesh, const Vec3d& center);

}  // namespace scree::affine
