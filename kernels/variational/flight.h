#pragma once
// The way of a body between two nodes of the discrete path. With the Verlet discrete Lagrangian
// L_d(a, b, h) = m |b - a|^2 / (2 h) - h (V(a) + V(b)) / 2 and uniform gravity it is the parabola of
// free fall, for a whole step and for any part of one. docs/theory.md, section "Variational collisions".

#include "kernels/math/vec3.h"

namespace scree {

/// Stands for the time of what does not happen [s].
inline constexpr double kNever = 1e300;

/// Free fall from a node on.
struct Flight {
  Vec3<double> x;  ///< at the node [m]
  Vec3<double> v;  ///< momentum over mass there [m/s]
  Vec3<double> g;  ///< gravity [m/s^2]

  SCREE_HD Vec3<double> place(double s) const { return x + s * (v + (0.5 * s) * g); }
  SCREE_HD Vec3<double> velocity(double s) const { return v + s * g; }
  /// No part of the flight up to s is farther than this from its chord [m].
  SCREE_HD double sag(double s) const { return 0.125 * s * s * norm(g); }
};

/// A body at its last node of the step: where it is, and when that was.
struct Node {
  Vec3<double> x;  ///< [m]
  Vec3<double> v;  ///< momentum over mass [m/s]
  double t = 0;    ///< since the start of the step [s]

  /// Where free fall brings it. @param to  not before t [s]
  SCREE_HD Node at(double to, const Vec3<double>& g) const {
    const Flight f{x, v, g};
    return {f.place(to - t), f.velocity(to - t), to};
  }
};

}  // namespace scree
