#pragma once
// The rotation of a free rigid body, by the exact discrete Lagrangian.
//
// A variational integrator of the rotation group has a discrete Lagrangian L_d(q, q', h), which stands for the action of a
// step (Moser, Veselov, Commun. Math. Phys. 139 (1991); Marsden, Pekarsky, Shkoller, Nonlinearity 12 (1999); McLachlan,
// Scovel, J. Nonlinear Sci. 5 (1995)). What comes from it keeps the spatial angular momentum L, and the discrete energy
// -dL_d / dh differs from that of the state by O(h^2). With the action of the solution itself (the exact discrete Lagrangian,
// Marsden, West, Acta Numerica 10 (2001)) the steps are the flow and that difference is zero, so that parts of steps
// before and after an impact have one energy. For a free body this costs no more than the equations of the others, which
// have no closed form: the flow is
//
//     (V1) q' = exp(h L / J1) q exp(h (1 - J3 / J1) w3 e3)                  two equal moments J1
//
// or a power series. With times in units of the step, the body rate w = sum A_n t^n and the turn F = sum B_n t^n have
//
//     (V2) (n + 1) A_(n+1),i = (J_j - J_k) / J_i sum_m A_m,j A_(n-m),k      Euler's equations
//          (n + 1) B_(n+1)   = sum_m B_m (0, A_(n-m)) / 2                   F' = F (0, w) / 2
//
// No moment is above the sum of the others, so the factors of (V2) are at most one, y' = y^2 is a majorant, and the radius
// of convergence is at least one over the largest component of h w.
//
// The implicit midpoint rule of kernels/step/integrate.h keeps L and is of second order, but comes from no such Lagrangian.

#include <cmath>

#include "kernels/math/quat.h"

namespace scree {

using Vec3d = Vec3<double>;
using Quatd = Quat<double>;

/// Whether all axes are principal: every free rotation is steady.
SCREE_HD inline bool is_isotropic(const Vec3d& moments) {
  return moments.x == moments.y && moments.y == moments.z;
}
/// The axis whose moment differs from the other two, which are equal; -1: there is none.
SCREE_HD inline int axis_of_symmetry(const Vec3d& moments) {
  constexpr double kSame = 1e-15;
  for (int k = 0; k < 3; ++k) {
    const double a = moments[(k + 1) % 3], b = moments[(k + 2) % 3];
    if (std::abs(a - b) <= kSame * a) return k;
  }
  return -1;
}

/// Rate in the frame of the body [rad/s]. @param momentum  in the same frame [kg m^2/s]
SCREE_HD inline Vec3d rate_of(const Vec3d& moments, const Vec3d& momentum) {
  return {momentum.x / moments.x, momentum.y / moments.y, momentum.z / moments.z};
}
/// Energy of a rotation [J]. @param momentum  in the frame of the body
SCREE_HD inline double spin_energy(const Vec3d& moments, const Vec3d& momentum) {
  return 0.5 * dot(momentum, rate_of(moments, momentum));
}

namespace variational_parts {

/// The turn of a part of a step by (V2), and the rate after it.
/// @param w  rate over the length of the part, each component at most kMostOfPart [rad]; in and out
SCREE_HD inline Quatd series_turn(const Vec3d& moments, Vec3d& w) {
  // (1/8)^17 is below half a unit in the last place.
  constexpr int kTerms = 17;
  const Vec3d factor{(moments.y - moments.z) / moments.x, (moments.z - moments.x) / moments.y,
                     (moments.x - moments.y) / moments.z};
  Vec3d a[kTerms];
  Quatd b[kTerms + 1];
  a[0] = w;
  Vec3d vector;
  double scalar = 1;
  for (int n = 0; n < kTerms; ++n) {
    Vec3d rise, turn;
    double real = 0;
    for (int m = 0; m <= n; ++m) {
      const Vec3d &x = a[m], &y = a[n - m];
      rise += Vec3d{x.y * y.z, x.z * y.x, x.x * y.y};
      real -= dot(b[m].vec(), y);
      turn += b[m].w * y + cross(b[m].vec(), y);
    }
    const double part = 1.0 / (n + 1);
    b[n + 1] = {0.5 * part * real, 0.5 * part * turn.x, 0.5 * part * turn.y, 0.5 * part * turn.z};
    scalar += b[n + 1].w;
    vector += b[n + 1].vec();
    if (n + 1 == kTerms) break;
    a[n + 1] = part * hadamard(factor, rise);
    w += a[n + 1];
    // What comes is smaller by the ratio of the terms each time.
    const double left = norm2(a[n + 1]) + norm2(b[n + 1].vec()) + b[n + 1].w * b[n + 1].w;
    if (left < 1e-36) break;
  }
  return normalized(Quatd{scalar, vector.x, vector.y, vector.z});
}

}  // namespace variational_parts

/// The largest component of what a part of a step may turn by, where it needs a series [rad], and the most parts.
inline constexpr double kMostOfPart = 0.125;
inline constexpr int kMostParts = 4000;

/// The turn of a free body in a step of any length: q' = q turn.
/// @param moments   principal moments, > 0 [kg m^2]
/// @param momentum  q^T L: angular momentum in the frame of the body at the start [kg m^2/s]
/// @param h         length of the step [s]; negative: back in time
[[gnu::noinline]] SCREE_HD inline Quatd free_turn(const Vec3d& moments, const Vec3d& momentum,
                                                  double h) {
  Vec3d rate = rate_of(moments, momentum);
  if (is_isotropic(moments)) return exp_map(h * rate);
  const int axis = axis_of_symmetry(moments);
  if (axis >= 0) {
    const double across = moments[(axis + 1) % 3];
    Vec3d own;
    own[axis] = h * (1 - moments[axis] / across) * rate[axis];
    return exp_map((h / across) * momentum) * exp_map(own);
  }
  Quatd turn;
  double left = h;
  for (int part = 0; part < kMostParts && left != 0; ++part) {
    double most = 0;
    for (int k = 0; k < 3; ++k) most = std::abs(rate[k]) > most ? std::abs(rate[k]) : most;
    double length = left;
    if (std::abs(left) * most > kMostOfPart)
      length = (left < 0 ? -kMostOfPart : kMostOfPart) / most;
    Vec3d w = length * rate;
    turn = turn * variational_parts::series_turn(moments, w);
    rate = (1 / length) * w;
    left -= length;
  }
  return turn;
}

/// The orientation after a step of a free body, whose spatial angular momentum stays [kg m^2/s].
SCREE_HD inline Quatd turned_freely(const Vec3d& moments, const Vec3d& momentum, double h,
                                    const Quatd& q) {
  return normalized(q * free_turn(moments, rotate_back(q, momentum), h));
}

}  // namespace scree
