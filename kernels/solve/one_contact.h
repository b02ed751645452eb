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
    return step_of<R>(problem(), beta, length, v_a, v_b, next, exact);
  }

 protected:
  SCREE_HD ContactProblem<Real> problem() {
    ContactProblem<Real> p;
    p.normal = {&normal, 1};
    p.bias.values = {&bias, 1};
    p.friction.values = {&friction, 1};
    p.adhesion.values = {&adhesion, 1};
    return p;
  }
  template <class R>
  SCREE_HD Sums<2> step_of(const ContactProblem<Real>& p, Real beta, Real length,
                           const Twist<Real>& v_a, const Twist<Real>& v_b, Vec3<Real>& next,
                           bool exact) {
    const ApgdContactStep<R, Real> one{{&gamma, 1}, {&previous, 1}, {&next, 1}, {},
                                       beta,        length,         exact};
    return one(p, StoredMetric<R, Real>{{weights, 2}}, 0, v_a, v_b);
  }
};

/// Contact with lever arms of the mixed layout.
template <class Real>
struct OneGeneralContact : OneContact<Real> {
  Vec3<Real> arm_a, arm_b, drift;

  /// @tparam R  GeneralRows<Real, true>, or ImpactRows of these
  template <class R>
  SCREE_HD Sums<2> step(Real beta, Real length, const Twist<Real>& v_a, const Twist<Real>& v_b,
                        Vec3<Real>& next, bool exact) {
    ContactProblem<Real> p = this->problem();
    p.arm_a = {&arm_a, 1};
    p.arm_b = {&arm_b, 1};
    p.drift = {&drift, 1};
    return this->template step_of<R>(p, beta, length, v_a, v_b, next, exact);
  }
};

}  // namespace scree
