#pragma once
// The configuration update x' = x + h v', q' = exp(h w') q, and the torque-free rotation of bodies
// whose principal moments differ. docs/theory.md, section "Rotation".

#include "kernels/backend/backend.h"
#include "kernels/bodies/body_view.h"
#include "kernels/bodies/range.h"
#include "kernels/contact/contact_problem.h"
#include "kernels/step/guarded_way.h"
#include "kernels/step/step_setup.h"

namespace scree {

/// The most of h |L| / (the least moment) for which the midpoint rule is taken, and of h |w| for a part of a split step [rad].
inline constexpr double kMostMidpointTurn = 0.25;
inline constexpr int kMostTurnParts = 1024;

/// One step of the implicit Lie midpoint rule: w_m = I(q_m)^-1 L with q_m = exp(h w_m / 2) q; q' = exp(h w_m) q.
/// @param inverse   of the principal moments
/// @param momentum  L, in space
/// @param w         where the search for w_m begins
template <class Real>
SCREE_HD Quat<Real> midpoint_turn(Real h, const Vec3<Real>& inverse, const Vec3<Real>& momentum,
                                  const Quat<Real>& q, const Vec3<Real>& w) {
  Vec3<Real> w_mid = w;
  // Fixed-point iteration; contracts by about h |L| / 2 over the least moment per turn, so far fewer turns do.
  for (int k = 0; k < 30; ++k) {
    const Quat<Real> q_mid = exp_map((h / 2) * w_mid) * q;
    const Vec3<Real> next = rotate(q_mid, hadamard(inverse, rotate_back(q_mid, momentum)));
    const Real change = norm2(next - w_mid);
    w_mid = next;
    if (change <= norm2(next) * (sizeof(Real) == 8 ? Real(1e-30) : Real(1e-13))) break;
  }
  return turned_by(h * w_mid, q);
}

/// A step in turns that are known, for bodies that are long and thin or turn far in a step: half a turn by what one of the two
/// moments nearest to each other differs from the other, a turn of the body with both equal, J, and the other half.
///
///     q exp(h/2 D L_b e_b);   exp(h L / J) q exp(h (1 / I_k - 1 / J) L_k e_k);   D = 1 / I_b - 1 / J
///
/// Exact for bodies with two equal moments. Else of second order, without trend in the energy, since it is symplectic.
/// Source: Dullweber, Leimkuhler, McLachlan, J. Chem. Phys. 107(15), 1997, "symmetric rotor splitting".
/// @param q  orientation at the start; momentum, w as above
template <class Real>
SCREE_HD Quat<Real> split_turn(Real h, const Vec3<Real>& inverse, const Vec3<Real>& momentum,
                               Quat<Real> q, const Vec3<Real>& w) {
  int k = 0;  // the axis of the turn that is left
  for (int axis = 1; axis < 3; ++axis) {
    const auto apart = [&](int i) { return std::abs(inverse[(i + 1) % 3] - inverse[(i + 2) % 3]); };
    if (apart(axis) < apart(k)) k = axis;
  }
  const int b = (k + 2) % 3;
  const Real shared = inverse[(k + 1) % 3], own = inverse[k] - shared, rest = inverse[b] - shared;
  const auto turned = [&](const Quat<Real>& from, int axis, Real rate, Real time) {
    Vec3<Real> angle;
    angle[axis] = time * rate * rotate_back(from, momentum)[axis];
    return from * exp_map(angle);
  };
  if (is_zero(rest)) return normalized(exp_map(h * shared * momentum) * turned(q, k, own, h));
  const Real wanted = h * norm(w) / Real(kMostMidpointTurn);
  const int parts = wanted < Real(kMostTurnParts) ? static_cast<int>(wanted) + 1 : kMostTurnParts;
  const Real time = h / static_cast<Real>(parts);
  for (int part = 0; part < parts; ++part) {
    q = turned(q, b, rest, time / 2);
    q = exp_map(time * shared * momentum) * turned(q, k, own, time);
    q = normalized(turned(q, b, rest, time / 2));
  }
  return q;
}

/// Torque-free rotation over one step, with the spatial angular momentum carried exactly: by the midpoint rule or, where its
/// iteration would not contract, by known turns. The energy error is O(h^2) without trend. Then w' = I(q')^-1 L.
/// @param moments  principal moments, body frame [kg m^2]
template <class Real>
SCREE_HD void rotate_free(Real h, const Vec3<Real>& moments, Quat<Real>& q, Vec3<Real>& w) {
  const Vec3<Real> inverse{Real(1) / moments.x, Real(1) / moments.y, Real(1) / moments.z};
  const Vec3<Real> momentum = rotate(q, hadamard(moments, rotate_back(q, w)));
  Real most = inverse.x;
  for (int axis = 1; axis < 3; ++axis) most = inverse[axis] > most ? inverse[axis] : most;
  q = h * most * norm(momentum) > Real(kMostMidpointTurn)
          ? split_turn(h, inverse, momentum, q, w)
          : midpoint_turn(h, inverse, momentum, q, w);
  w = rotate(q, hadamard(inverse, rotate_back(q, momentum)));
  // One step of iterative refinement: without it the rounding of a slightly long or short
  // quaternion adds up over the steps.
  const Vec3<Real> missing = momentum - rotate(q, hadamard(moments, rotate_back(q, w)));
  w += rotate(q, hadamard(inverse, rotate_back(q, missing)));
}

/// The same for a body that may turn about two axes of the world only: what holds the third gives a moment about that one, so the
/// momentum about the others stays. By the midpoint rule, as midpoint_turn().
/// @param axes  bit k set: axis k may turn
template <class Real>
SCREE_HD void rotate_on_axes(Real h, const Vec3<Real>& moments, unsigned axes, Quat<Real>& q,
                             Vec3<Real>& w) {
  const Vec3<Real> momentum = rotated_diagonal(q, moments) * w;
  const auto rate = [&](const Quat<Real>& at) {
    return inverse_on_axes(rotated_diagonal(at, moments), axes) * momentum;
  };
  Vec3<Real> w_mid = w;
  for (int k = 0; k < 10; ++k) w_mid = rate(exp_map((h / 2) * w_mid) * q);
  q = turned_by(h * w_mid, q);
  w = rate(q);
}

/// Turns body i for a step. @param q, w  orientation and the solved angular velocity, in and out
template <class Real>
SCREE_HD void turn_body(const BodyView<Real>& bodies, Index i, Real h, Quat<Real>& q,
                        Vec3<Real>& w) {
  const Vec3<Real> moments = bodies.moments(i);
  const bool isotropic = moments.x == moments.y && moments.y == moments.z;
  const unsigned axes = free_angular_axes(bodies.locks[i]);
  const bool has_two = axes == 3u || axes == 5u || axes == 6u;
  if (isotropic || !(axes == 7u || has_two)) {
    q = turned_by(h * w, q);
  } else if (axes == 7u) {
    rotate_free(h, moments, q, w);
  } else {
    rotate_on_axes(h, moments, axes, q, w);
  }
}

/// Sums of the integration pass.
struct IntegrateSums {
  double kinetic_energy = 0;  ///< [J]
  Index bad_body = -1;        ///< lowest storage index with a state that is not finite, too far
                              ///< out or too fast
  Index stopped = 0;          ///< bodies that a wall kept from going all their way
  SCREE_HD void combine(const IntegrateSums& o) {
    kinetic_energy += o.kinetic_energy;
    stopped += o.stopped;
    if (o.bad_body >= 0 && (bad_body < 0 || o.bad_body < bad_body)) bad_body = o.bad_body;
  }
};

/// Periodic box in world axes; a zero length means the axis is not periodic.
struct PeriodicBox {
  Vec3<double> lower;
  Vec3<double> length;
};

/// x moved by whole periods into [lower, lower + length).
SCREE_HD inline double wrap_coordinate(double x, double lower, double length) {
  if (length <= 0) return x;
  x -= length * std::floor((x - lower) / length);
  return x < lower + length ? x : lower;  // rounding may land exactly on the upper end
}

/// Takes the solved velocities over and moves the body.
/// Bytes per body (radial, float): 24 + 24 + 16 + 24 + 16 read, 24 + 16 + 24 written.
/// @tparam Way  StraightWay or GuardedWay
template <class Real, class Way>
struct Integrate {
  static constexpr const char* name = "integrate";
  BodyView<Real> bodies;
  Span<const Twist<Real>> solved;
  bool radial;       ///< angular part of `solved` is r w
  double time_step;  ///< h [s]
  PeriodicBox box;
  Way way;

  SCREE_HD IntegrateSums operator()(Index i) const {
    const Vec3<Real> v = solved[i].linear;
    Vec3<Real> w = radial ? (Real(1) / bodies.radius[i]) * solved[i].angular : solved[i].angular;
    Quat<Real> q = bodies.orientation[i];
    const Vec3<Real> moments = bodies.moments(i);
    turn_body(bodies, i, static_cast<Real>(time_step), q, w);
    bool stopped = false;
    Vec3<double> x = way.end(i, v, stopped);
    for (int axis = 0; axis < 3; ++axis)
      x[axis] = wrap_coordinate(x[axis], box.lower[axis], box.length[axis]);

    bodies.velocity[i] = v;
    bodies.angular_velocity[i] = w;
    bodies.orientation[i] = q;
    bodies.position[i] = x;

    IntegrateSums s;
    s.stopped = stopped ? 1 : 0;
    const Vec3<Real> w_body = rotate_back(q, w);
    s.kinetic_energy = 0.5 * (static_cast<double>(norm2(v)) / bodies.inv_mass[i] +
                              static_cast<double>(dot(w_body, hadamard(moments, w_body))));
    if (!(s.kinetic_energy < 1e300) || !is_in_range(x) ||
        !is_speed_in_range(norm(Vec3<double>(v)), time_step)) {
      s.bad_body = i;
    }
    return s;
  }
};

}  // namespace scree
