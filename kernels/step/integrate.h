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

/// Torque-free rotation over one step by the implicit Lie midpoint rule with the spatial angular
/// momentum carried exactly: w_m = I(q_m)^-1 L with q_m = exp(h w_m / 2) q; q' = exp(h w_m)
/// q; w' = I(q')^-1 L. Conserves L to rounding; the energy error is O(h^2) without trend.
/// @param moments  principal moments, body frame [kg m^2]
template <class Real>
SCREE_HD void rotate_free(Real h, const Vec3<Real>& moments, Quat<Real>& q, Vec3<Real>& w) {
  const Vec3<Real> inverse{Real(1) / moments.x, Real(1) / moments.y, Real(1) / moments.z};
  const Vec3<Real> momentum = rotate(q, hadamard(moments, rotate_back(q, w)));
  Vec3<Real> w_mid = w;
  // Fixed-point iteration; contracts by about h |w| per turn. The cap is far above what a sensible
  // step needs and only bounds the time of a senseless one.
  for (int k = 0; k < 30; ++k) {
    const Quat<Real> q_mid = exp_map((h / 2) * w_mid) * q;
    const Vec3<Real> next = rotate(q_mid, hadamard(inverse, rotate_back(q_mid, momentum)));
    const Real change = norm2(next - w_mid);
    w_mid = next;
    if (change <= norm2(next) * (sizeof(Real) == 8 ? Real(1e-30) : Real(1e-13))) break;
  }
  q = normalized(exp_map(h * w_mid) * q);
  w = rotate(q, hadamard(inverse, rotate_back(q, momentum)));
  // One step of iterative refinement: without it the rounding of a slightly long or short
  // quaternion adds up over the steps.
  const Vec3<Real> missing = momentum - rotate(q, hadamard(moments, rotate_back(q, w)));
  w += rotate(q, hadamard(inverse, rotate_back(q, missing)));
}

/// Turns body i for a step. @param q, w  orientation and the solved angular velocity, in and out
template <class Real>
SCREE_HD void turn_body(const BodyView<Real>& bodies, Index i, Real h, Quat<Real>& q,
                        Vec3<Real>& w) {
  const Vec3<Real> moments = bodies.moments(i);
  const bool isotropic = moments.x == moments.y && moments.y == moments.z;
  if (isotropic || free_angular_axes(bodies.locks[i]) != 7u) {
    q = normalized(exp_map(h * w) * q);
  } else {
    rotate_free(h, moments, q, w);
  }
}

/// Sums of the integration pass.
struct IntegrateSums {
  double kinetic_energy = 0;  ///< [J]
  Index bad_body = -1;        ///< lowest storage index with a state that is not finite, too far
                              ///< out or too fast
  Index stopped = 0;          ///< spheres that a wall kept from going all their way
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
