#pragma once
// Newton steps that go on as a turn does. A step is straight in twelve coordinates, so it stretches a body that turns and takes one
// that turns about a point out of its way by half the square of the angle. docs/theory.md, "Barrier contact".

#include "kernels/affine/inertial_target.h"

namespace scree::affine {

/// A bound of how far the end of a bent step may be from that of the straight one, nearly [m].
SCREE_HD inline double bend_of(const AffineVec& step, double radius) {
  double turn = 0;
  for (int k = 1; k < 4; ++k) turn += norm2(step.node[k]);
  return 0.5 * (turn * radius + std::sqrt(turn) * norm(step.node[0]));
}

/// Where a body is after a Newton step whose turn is a turn. The center of mass of one that flies goes straight; that of one
/// that others guide goes with the turn, about its axis.
/// @param free  where inertia and loads take the center of mass
SCREE_HD inline AffineVec bent_end(const AffineMass& mass, const AffineVec& q,
                                   const AffineVec& step, const Vec3d& free) {
  constexpr double kGuided = 0.1;  // of the way that is not free
  const Vec3d way = step.node[0], w = turn_rate(mass, q, angular_momentum(mass, q, step));
  AffineVec stretched = q;
  for (int k = 1; k < 4; ++k) stretched.node[k] += step.node[k] - cross(w, q.node[k]);
  AffineVec end = turned(stretched, w);
  end.node[0] = q.node[0] + way;
  if (norm(free - end.node[0]) > kGuided * norm(way)) {
    const double square = norm2(w), angle = std::sqrt(square);
    const bool is_small = angle < 1e-3;
    const double first = is_small ? 0.5 : (1 - std::cos(angle)) / square;
    const double second = is_small ? 1.0 / 6 : (angle - std::sin(angle)) / (angle * square);
    const Vec3d turned_way = cross(w, way);
    end.node[0] += first * turned_way + second * cross(w, turned_way);
  }
  return end;
}

}  // namespace scree::affine
