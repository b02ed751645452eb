#pragma once
// One projected step of a contact in a diagonal metric: what Jacobi and Gauss-Seidel
// have in common.

#include "kernels/contact/contact_operator.h"

namespace scree {

/// P_K(gamma - omega D^-1 u), both in the metric D. For D >= N_cc and omega < 2 the objective
/// falls by at least (1/omega - 1/2) |move|_D^2; for D = N_cc and omega = 1 it is the
/// contact's exact minimizer.
/// @param u           contact velocity J V + bias at gamma [m/s]
/// @param relaxation  omega, in (0, 2)
/// Source: docs/theory.md, section "Gauss-Seidel and Jacobi".
template <class R, class Real>
SCREE_HD typename R::Rows metric_step(const ContactProblem<Real>& p, Index c,
                                      const typename R::Rows& gamma, const typename R::Rows& u,
                                      const ContactMetric<Real>& metric, Real relaxation) {
  if constexpr (R::kHasJoints) {
    if (R::is_joint(p, c))
      return R::Joints::project(p, c, gamma - relaxation * solve_metric(metric, p.normal[c], u),
                                relaxation / metric.normal);
  }
  return R::project(p, c, gamma - relaxation * solve_metric(metric, p.normal[c], u), metric);
}

/// Bound of contact c's own block N_cc.
template <class R, class Real>
SCREE_HD ContactMetric<Real> own_metric(const ContactProblem<Real>& p, Index c) {
  return floor_metric(R::block_metric(p, c), R::block_trace(p, c));
}

/// metric[c] = own_metric, for methods that move one contact of a body at a time.
template <class R, class Real>
struct StoreBlockMetric {
  static constexpr const char* name = "block_metric";
  ContactProblem<Real> p;
  Span<ContactMetric<Real>> metric;
  SCREE_HD void operator()(Index c) const { metric[c] = own_metric<R>(p, c); }
};

/// metric[c] = mass-split bound: all contacts may move at once.
template <class R, class Real>
struct StoreMassSplitMetric {
  static constexpr const char* name = "mass_split_metric";
  ContactProblem<Real> p;
  Span<ContactMetric<Real>> metric;
  SCREE_HD void operator()(Index c) const {
    metric[c] = floor_metric(mass_split_metric<R>(p, c), R::block_trace(p, c));
  }
};

}  // namespace scree
