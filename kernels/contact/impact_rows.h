#pragma once
// Contact rows of an impact: the cone of a contact, cut off below a least normal impulse. A contact
// has no cohesion in an impact; ContactProblem::adhesion holds the least normal impulse instead. Joints are as in a step.
// docs/theory.md, section "Impacts".

#include "kernels/contact/contact_rows.h"

namespace scree {

/// Nearest point of { n >= least, |t| <= mu n } in the contact's metric: that of the cone where it
/// lies high enough, else on the cut, whose disk bounds the friction.
/// @param y  impulse, world frame [N s]
template <class Real>
SCREE_HD ForceRows<Real> project_above(const ContactProblem<Real>& p, Index c, Real least,
                                       const ForceRows<Real>& y, const ContactMetric<Real>& m) {
  const Vec3<Real> n = p.normal[c];
  const Real mu = p.friction[c], bound = mu * (m.tangential * least);
  const Vec3<Real> x = project_cone(mu, n, y.force, m.normal, m.tangential);
  const auto is_high = dot(n, x) >= least;
  const Vec3<Real> slide = y.force - dot(n, y.force) * n;
  const Real square = norm2(m.tangential * slide);
  const Real scale = select(square <= bound * bound, Real(1), bound * inverse_sqrt(square));
  const Vec3<Real> cut = least * n + scale * slide;
  return {{select(is_high, x.x, cut.x), select(is_high, x.y, cut.y), select(is_high, x.z, cut.z)}};
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
    if constexpr (R::kHasJoints) {
      if (R::is_joint(p, c)) return R::project(p, c, y, m);
    }
    return project_above(p, c, p.adhesion[c], y, m);
  }
};

}  // namespace scree
