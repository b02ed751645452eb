#pragma once
// Contact rows of an impact: the cone of a contact, cut off below a least normal impulse. A contact
// has no cohesion in an impact; ContactProblem::adhesion holds the least normal impulse instead.
// docs/theory.md, section "Impacts".

#include "kernels/contact_rows.h"

namespace scree {

/// Nearest point of { n >= least, |t| <= mu n } in the contact's metric: that of the cone where it
/// lies high enough, else on the cut, whose disk bounds the friction.
/// @param y  impulse, world frame [N s]
template <class Real>
SCREE_HD ForceRows<Real> project_above(const ContactProblem<Real>& p, Index c, Real least,
                                       const ForceRows<Real>& y, const ContactMetric<Real>& m) {
  const Vec3<Real> n = p.normal[c];
  const Real mu = p.friction[c];
  const Vec3<Real> x = project_cone(mu, n, y.force, m.normal, m.tangential);
  if (!(dot(n, x) < least)) return {x};
  const Vec3<Real> slide = y.force - dot(n, y.force) * n;
  const Real length = norm(slide), bound = mu * least;
  return {least * n + (length > bound ? bound / length : Real(1)) * slide};
}
template <class Real>
SCREE_HD ForceMomentRows<Real> project_above(const ContactProblem<Real>& p, Index c, Real least,
                                             const ForceMomentRows<Real>& y,
                                             const ContactMetric<Real>& m) {
  return RollingRows<Real>::project_above(p, c, y, m, Real(0), least);
}

/// The rows R with such cones.
template <class R>
struct ImpactRows : R {
  using Rows = typename R::Rows;
  template <class Real>
  static SCREE_HD Rows project(const ContactProblem<Real>& p, Index c, const Rows& y,
                               const ContactMetric<Real>& m) {
    return project_above(p, c, p.adhesion[c], y, m);
  }
};

}  // namespace scree
