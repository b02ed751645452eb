#pragma once
// The values of the rows of one contact, and its diagonal metric.

#include "kernels/contact/contact_problem.h"

namespace scree {

/// Force rows of one contact, world frame [N s]; as a velocity [m/s].
template <class Real>
struct ForceRows {
  Vec3<Real> force;

  friend SCREE_HD ForceRows operator+(const ForceRows& a, const ForceRows& b) {
    return {a.force + b.force};
  }
  friend SCREE_HD ForceRows operator-(const ForceRows& a, const ForceRows& b) {
    return {a.force - b.force};
  }
  friend SCREE_HD ForceRows operator*(Real s, const ForceRows& a) { return {s * a.force}; }
  friend SCREE_HD Real dot(const ForceRows& a, const ForceRows& b) { return dot(a.force, b.force); }
};

/// Force and moment rows of one contact, world frame, moments divided by the contact's
/// length [N s].
template <class Real>
struct ForceMomentRows {
  Vec3<Real> force;
  Vec3<Real> moment;

  friend SCREE_HD ForceMomentRows operator+(const ForceMomentRows& a, const ForceMomentRows& b) {
    return {a.force + b.force, a.moment + b.moment};
  }
  friend SCREE_HD ForceMomentRows operator-(const ForceMomentRows& a, const ForceMomentRows& b) {
    return {a.force - b.force, a.moment - b.moment};
  }
  friend SCREE_HD ForceMomentRows operator*(Real s, const ForceMomentRows& a) {
    return {s * a.force, s * a.moment};
  }
  friend SCREE_HD Real dot(const ForceMomentRows& a, const ForceMomentRows& b) {
    return dot(a.force, b.force) + dot(a.moment, b.moment);
  }
};

/// Rows directions that no body can follow (a locked axis) have weight zero; the step divides
/// by weights, so they are raised to this share of the block's trace. A larger weight is
/// still a bound from above.
template <class Real>
SCREE_HD ContactMetric<Real> floor_metric(const ContactMetric<Real>& m, Real trace) {
  const Real least = trace > Real(0) ? Real(1e-5) * trace : Real(1);
  return {m.normal > least ? m.normal : least, m.tangential > least ? m.tangential : least,
          m.moment > least ? m.moment : least};
}

/// H^-1 x for the contact metric H = diag(normal, tangential, tangential[, moment]).
template <class Real>
SCREE_HD ForceRows<Real> solve_metric(const ContactMetric<Real>& m, const Vec3<Real>& n,
                                      const ForceRows<Real>& x) {
  const Real x_n = dot(n, x.force);
  const Real inv_t = inverse(m.tangential);
  return {inv_t * x.force + (x_n * (inverse(m.normal) - inv_t)) * n};
}
template <class Real>
SCREE_HD ForceMomentRows<Real> solve_metric(const ContactMetric<Real>& m, const Vec3<Real>& n,
                                            const ForceMomentRows<Real>& x) {
  return {solve_metric(m, n, ForceRows<Real>{x.force}).force, inverse(m.moment) * x.moment};
}

/// x^T H y. Weights come first: the products of impulses alone, of grains of a micrometer or of a kilometer, are no float.
template <class Real>
SCREE_HD Real metric_dot(const ContactMetric<Real>& m, const Vec3<Real>& n,
                         const ForceRows<Real>& x, const ForceRows<Real>& y) {
  return dot(m.tangential * x.force, y.force) +
         (m.normal - m.tangential) * dot(n, x.force) * dot(n, y.force);
}
template <class Real>
SCREE_HD Real metric_dot(const ContactMetric<Real>& m, const Vec3<Real>& n,
                         const ForceMomentRows<Real>& x, const ForceMomentRows<Real>& y) {
  return metric_dot(m, n, ForceRows<Real>{x.force}, ForceRows<Real>{y.force}) +
         dot(m.moment * x.moment, y.moment);
}
/// x^T H x.
template <class Real, class Rows>
SCREE_HD Real metric_norm2(const ContactMetric<Real>& m, const Vec3<Real>& n, const Rows& x) {
  return metric_dot(m, n, x, x);
}

/// Euclidean weights: the metric of plain projected gradients.
template <class Real>
SCREE_HD ContactMetric<Real> euclidean_metric() {
  return {1, 1, 1};
}

}  // namespace scree
