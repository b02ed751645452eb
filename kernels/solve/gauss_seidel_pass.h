#pragma once
// Gauss-Seidel on one contact, and what brings contacts into the order of their colors and back.

#include "kernels/solve/metric_step.h"

namespace scree {

/// Solves contact `first + k` against the velocities its bodies have now, and moves the two bodies
/// at once. Contacts run concurrently only when no two of them share an owned body; in sequence, in
/// any order. Bytes per contact (radial, float): read normal and bias 16, ids 8, metric 12, impulse
/// 12, two twists and inertias 64 gathered; written 12 and two twists 48.
template <class R, class Real>
struct GaussSeidelPass {
  static constexpr const char* name = "gauss_seidel_pass";
  ContactProblem<Real> p;
  Span<const ContactMetric<Real>> metric;  ///< D of each contact; empty: worked out on the way
  Span<Twist<Real>> velocity;              ///< V of the present impulses [body_count]
  Span<Vec3<Real>> gamma;
  Real relaxation;
  Index first = 0;
  Span<const Index> order = {};  ///< contacts to visit, where there are several groups

  SCREE_HD void operator()(Index k) const {
    const Index c = R::kHasLaterGroups && !order.empty() ? order[first + k] : first + k;
    const Index a = p.body_a[c], b = p.body_b[c];
    const Twist<Real> v_a = velocity[a], v_b = velocity[b];
    const auto old = R::load(gamma, c);
    const ContactMetric<Real> d = metric.empty() ? own_metric<R>(p, c) : metric[c];
    const auto next = metric_step<R>(p, c, old, R::velocity(p, c, v_a, v_b), d, relaxation);
    const auto move = next - old;
    R::store(gamma, c, next);
    velocity[a] = v_a + R::apply_inverse_mass(p, a, R::wrench(p, c, false, move));
    if (p.bodies.is_owned(b)) {
      velocity[b] = v_b + R::apply_inverse_mass(p, b, R::wrench(p, c, true, move));
    }
  }
};

/// to[k] = data of contact order[k], and its block metric: one pass per solve, so that every sweep
/// reads the contacts of a color as one contiguous stretch.
template <class R, class Real>
struct GatherContacts {
  static constexpr const char* name = "gather_contacts";
  ContactProblem<Real> p;
  Span<const Index> order;
  ProblemFields<InSpans<Real>> to;  ///< empty: fields that the problem does not store
  Span<ContactMetric<Real>> metric;
  SCREE_HD void operator()(Index k) const {
    const Index c = order[k];
    p.visit(CopyContact{c, k}, p, to);
    metric[k] = own_metric<R>(p, c);
  }
};

/// ordered[k] = gamma[order[k]].
template <class R, class Real>
struct GatherImpulses {
  static constexpr const char* name = "gather_impulses";
  Span<const Index> order;
  Span<const Vec3<Real>> gamma;
  Span<Vec3<Real>> ordered;
  SCREE_HD void operator()(Index k) const { R::store(ordered, k, R::load(gamma, order[k])); }
};

/// gamma[order[k]] = ordered[k].
template <class R, class Real>
struct ScatterImpulses {
  static constexpr const char* name = "scatter_impulses";
  Span<const Index> order;
  Span<const Vec3<Real>> ordered;
  Span<Vec3<Real>> gamma;
  SCREE_HD void operator()(Index k) const { R::store(gamma, order[k], R::load(ordered, k)); }
};

}  // namespace scree
