#pragma once
// The contact pass between two convex solves of the De Saxce fixed point.

#include "kernels/contact_operator.h"

namespace scree {

/// What the fixed point adds up over the contacts to choose its relaxation.
struct ShiftSums {
  double change_squares = 0;      ///< sum of change^2 [m^2/s^2]
  double last_by_difference = 0;  ///< sum of last change * (change - last change)
  double difference_squares = 0;  ///< sum of (change - last change)^2
  SCREE_HD void combine(const ShiftSums& o) {
    change_squares += o.change_squares;
    last_by_difference += o.last_by_difference;
    difference_squares += o.difference_squares;
  }
};

/// change[c] = De Saxce correction at the velocities minus the shift in use.
template <class R, class Real>
struct ShiftChange {
  static constexpr const char* name = "shift_change";
  ContactProblem<Real> p;  ///< the original problem
  Span<const Twist<Real>> velocity;
  Span<const Real> shift;        ///< [m/s]
  Span<Real> change;             ///< [m/s] in: the last one, zero for none
  Span<const Vec3<Real>> guess;  ///< not empty: contacts without an impulse here get no shift
  SCREE_HD ShiftSums operator()(Index c) const {
    const auto u = R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]);
    Real target = de_saxce_shift(p, c, u);
    if (!guess.empty()) {
      const auto g = R::load(guess, c);
      if (!(dot(g, g) > Real(0))) target = 0;
    }
    const double last = change[c];
    change[c] = target - shift[c];
    const double now = change[c];
    return {now * now, last * (now - last), (now - last) * (now - last)};
  }
};

/// shift[c] += relaxation change[c], bias[c] = original bias + shift[c].
template <class Real>
struct ShiftBias {
  static constexpr const char* name = "shift_bias";
  Real relaxation;
  ContactBias<Real> original_bias;
  Span<const Real> change;  ///< [m/s]
  Span<Real> shift;         ///< [m/s]
  Span<Real> bias;          ///< [m/s]
  SCREE_HD void operator()(Index c) const {
    shift[c] += relaxation * change[c];
    bias[c] = original_bias[c] + shift[c];
  }
};

}  // namespace scree
