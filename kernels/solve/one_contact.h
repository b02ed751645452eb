#pragma once
// The APGD step of one contact whose data are at hand. Tuned twins fetch them in their own order,
// one contact or several at a time (Real may be Lanes); the formulas are those of the plain pass.

#include "kernels/contact/impact_rows.h"
#include "kernels/solve/apgd_passes.h"

namespace scree {

/// Radial layout.
template <class Real>
struct OneContact {
  Vec3<Real> gamma, previous;  ///< impulses of the current iterate and of the one before
  Vec3<Real> normal;
  Real bias, friction, adhesion;
  Real weights[2];  ///< of the metric: normal and tangential

  /// @tparam R        rows of the radial layout: RadialRows<Real>, or ImpactRows of these
  /// @param v_a, v_b  V_y of its bodies
  /// @param next      gamma+, out
  /// @param exact     as of ApgdContactStep
  template <class R>
  SCREE_HD Sums<2> step(Real beta, Real length, const Twist<Real>& v_a, const Twist<Real>& v_b,
                        Vec3<Real>& next, bool exact) {
    ContactProblem<Real> p;
    p.normal = {&normal, 1};
    p.bias.values = {&bias, 1};
    p.friction.values = {&friction, 1};
    p.adhesion.values = {&adhesion, 1};
    const ApgdContactStep<R, Real> one{{&gamma, 1}, {&previous, 1}, {&next, 1}, {},
                                       beta,        length,         exact};
    return one(p, StoredMetric<R, Real>{{weights, 2}}, 0, v_a, v_b);
  }
};

}  // namespace scree
