#pragma once
// The contact pass of projected Jacobi; the body pass is BodyVelocity.

#include "kernels/solve/metric_step.h"

namespace scree {

/// gamma_c = P_K(gamma_c - omega P^-1 u_c) for all contacts at once, in the mass-split metric
/// P >= N. A contact reads only its own impulse, so the update is in place. Bytes per contact
/// (radial, float): normal and bias 16, ids 8, metric 12, impulse 12 read, two twists 48 gathered,
/// impulse 12 written.
template <class R, class Real>
struct JacobiPass {
  static constexpr const char* name = "jacobi_pass";
  ContactProblem<Real> p;
  Span<const ContactMetric<Real>> metric;
  Span<const Twist<Real>> velocity;  ///< V of the impulses before the pass [body_count]
  Span<Vec3<Real>> gamma;
  Real relaxation;

  SCREE_HD void operator()(Index c) const {
    const auto u = R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]);
    R::store(gamma, c, metric_step<R>(p, c, R::load(gamma, c), u, metric[c], relaxation));
  }
};

}  // namespace scree
