#pragma once
// Friction pyramids, inside the cones: |r_t| is bounded by a regular polygon of radius mu r_n with
// corners along e_j, unit vectors at equal angles, e_0 the first tangent. Source: Stewart and
// Trinkle, IJNME 39, 1996.

#include <cmath>
#include <numbers>

#include "kernels/types.h"

namespace scree {

/// Unit tangent that an edge of a pyramid leans to.
struct PyramidEdge {
  double t1 = 0, t2 = 0;
};

/// Edges at equal angles, the first along the first tangent.
struct Pyramid {
  static constexpr int most_sides = 8;
  int sides;
  PyramidEdge edge[most_sides];

  /// @param count  even, 4 to most_sides
  explicit Pyramid(int count) : sides(count) {
    for (int j = 0; j < sides; ++j) {
      const double angle = 2 * std::numbers::pi * j / sides;
      edge[j] = {std::cos(angle), std::sin(angle)};
    }
  }

  /// Multipliers of an impulse, of the nearest part of the pyramid in the same direction.
  SCREE_HD void split(double mu, const double* r, double* l) const {
    for (int j = 0; j < sides; ++j) l[j] = 0;
    if (!(r[0] > 0)) return;
    double used = 0;
    if (mu > 0) {
      const double t1 = r[1] / mu, t2 = r[2] / mu;
      for (int j = 0; j < sides; ++j) {
        const PyramidEdge a = edge[j], b = edge[(j + 1) % sides];
        const double det = a.t1 * b.t2 - a.t2 * b.t1;
        const double la = (t1 * b.t2 - t2 * b.t1) / det, lb = (a.t1 * t2 - a.t2 * t1) / det;
        if (la < 0 || lb < 0) continue;
        const double shrink = la + lb > r[0] ? r[0] / (la + lb) : 1;
        l[j] += shrink * la;
        l[(j + 1) % sides] += shrink * lb;
        used = shrink * (la + lb);
        break;
      }
    }
    for (int j = 0; j < sides; ++j) l[j] += (r[0] - used) / sides;  // opposite ones cancel
  }

  /// The impulse sum_j l_j (1, mu e_j).
  SCREE_HD void sum_up(double mu, const double* l, double* r) const {
    r[0] = r[1] = r[2] = 0;
    for (int j = 0; j < sides; ++j) {
      r[0] += l[j];
      r[1] += mu * edge[j].t1 * l[j];
      r[2] += mu * edge[j].t2 * l[j];
    }
  }

  /// mu max_j(-e_j.u_t), which is to pyramids what De Saxce's term is to cones: added to u_n it
  /// makes the law of the convex model that of exact friction on the pyramid.
  SCREE_HD double lift(double mu, const double* u) const {
    double most = 0;
    for (int j = 0; j < sides; ++j) {
      const double against = -mu * (edge[j].t1 * u[1] + edge[j].t2 * u[2]);
      if (against > most) most = against;
    }
    return most;
  }
};

}  // namespace scree
