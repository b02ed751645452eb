#pragma once
// Friction pyramids, inside the cones: |r_t| is bounded by a regular polygon of radius mu r_n with
// corners along e_j, unit vectors at equal angles, e_0 the first tangent.
// Source: Stewart and Trinkle, IJNME 39, 1996.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace scree {

/// e_j
struct PyramidEdge {
  double t1, t2;
};

/// @param sides  even, 4 or more
inline std::vector<PyramidEdge> pyramid_edges(int sides) {
  std::vector<PyramidEdge> e;
  for (int j = 0; j < sides; ++j) {
    const double angle = 2 * std::numbers::pi * j / sides;
    e.push_back({std::cos(angle), std::sin(angle)});
  }
  return e;
}

/// mu max_j(-e_j.u_t), which is to pyramids what De Saxce's term is to cones: added to u_n it makes
/// the law of the convex model that of exact friction on the pyramid.
inline double pyramid_lift(const std::vector<PyramidEdge>& e, double mu, const double* u) {
  double lift = 0;
  for (const PyramidEdge& j : e) lift = std::max(lift, -mu * (j.t1 * u[1] + j.t2 * u[2]));
  return lift;
}

}  // namespace scree
