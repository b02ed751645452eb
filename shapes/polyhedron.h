#pragma once
// Volume, center of mass and moments of a closed triangle surface, exactly.

#include <algorithm>
#include <array>
#include <cmath>

#include "shapes/shape.h"

namespace scree {

/// Of a solid of density one over its volume: moments are those of a unit mass.
struct SolidMoments {
  double volume = 0;                              ///< [m^3]
  Vec3d center;                                   ///< of mass [m]
  std::array<std::array<double, 3>, 3> second{};  ///< mean of x_i x_j about the center [m^2]

  /// Moments of inertia about the center, about axes that are principal [m^2].
  Vec3d principal_moments() const {
    return {second[1][1] + second[2][2], second[2][2] + second[0][0], second[0][0] + second[1][1]};
  }
};

/// Sums over the tetrahedra of the triangles and one point: of one with corners 0, a, b, c the integral of
/// x_i x_j is its volume / 20 times the sum of a_i a_j, b_i b_j, c_i c_j and of (a + b + c)_i (a + b + c)_j.
/// @param origin  that corner: of a closed surface any gives the same, but for rounding
inline SolidMoments moments_about(const TriangleMesh& mesh, const Vec3d& origin) {
  SolidMoments m;
  for (const std::array<int, 3>& t : mesh.triangles) {
    Vec3d corner[3], sum;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = mesh.vertices[static_cast<std::size_t>(t[k])] - origin;
      sum += corner[k];
    }
    const double volume = dot(corner[0], cross(corner[1], corner[2])) / 6;
    m.volume += volume;
    m.center += (volume / 4) * sum;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        double products = sum[i] * sum[j];
        for (const Vec3d& x : corner) products += x[i] * x[j];
        m.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] +=
            volume / 20 * products;
      }
    }
  }
  m.center *= 1 / m.volume;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double& s = m.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      s = s / m.volume - m.center[i] * m.center[j];
    }
  m.center += origin;
  return m;
}

inline SolidMoments moments_of(const TriangleMesh& mesh) {
  return moments_about(mesh, mesh.vertices.empty() ? Vec3d{} : mesh.vertices[0]);
}

/// Half extents of the box about the origin that holds a mesh [m].
inline Vec3d box_about(const TriangleMesh& mesh) {
  Vec3d half;
  for (const Vec3d& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) half[k] = std::max(half[k], std::abs(v[k]));
  return half;
}

}  // namespace scree
