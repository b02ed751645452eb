#pragma once
// Where a mesh in a periodic domain meets its own images.

#include <array>
#include <vector>

#include "kernels/math/vec3.h"
#include "kernels/types.h"

namespace scree {

/// A mesh that is as long as its period: what lies in the plane of its upper end, and in that of its lower end.
struct MeshSeam {
  Vec3<double> period;        ///< from the lower end to the upper end, in the frame of the mesh [m]
  std::vector<Index> before;  ///< [vertices] of one at the upper end the one at the lower; else -1
  std::vector<Index> after;   ///< [vertices] of one at the lower end the one at the upper; else -1
  double mismatch = 0;        ///< farthest that one lies from the image of the other [m]
};

/// Of the box around points [m].
double diagonal_of(const std::vector<Vec3<double>>& points);

/// Finds the seams of a mesh, and takes the triangles out that lie in them: they are inside of what the images make together.
/// Ends that are not a period apart, or whose vertices do not all meet those of the other, within 1e-6 of the size of the mesh,
/// are no seam.
/// @param points     of the mesh [m]
/// @param triangles  of these points
/// @param closed     whether the mesh is the surface of a solid; else no triangle is inside
/// @param periods    in the frame of the mesh [m]
std::vector<MeshSeam> take_seams(const std::vector<Vec3<double>>& points,
                                 std::vector<std::array<Index, 3>>& triangles, bool closed,
                                 const std::vector<Vec3<double>>& periods);

}  // namespace scree
