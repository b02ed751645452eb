#pragma once
// The contact pass between two convex solves of the De Saxce fixed point.

#include "kernels/contact_operator.h"

namespace scree {

/// shift[c] = De Saxce correction at the velocities, bias[c] = original bias + shift; sums squared
/// changes.
template <class R, class Real>
struct ShiftBias {
  static constexpr const char* name = "shift_bias";
  ContactProblem<Real> p;  ///< the original problem
  Span<const Twist<Real>> velocity;
  Span<Real> shift;              ///< [m/s]
  Span<Real> bias;               ///< [m/s]
  Span<const Vec3<Real>> guess;  ///< not empty: contacts without an impulse here get no shift
  SCREE_HD Sums<1> operator()(Index c) const {
    const auto u = R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]);
    Real next = de_saxce_shift(p, c, u);
    if (!guess.empty()) {
      const auto g = R::load(guess, c);
      if (!(dot(g, g) > Real(0))) next = 0;
    }
    const double change = static_cast<double>(next) - shift[c];
    shift[c] = next;
    bias[c] = p.bias[c] + next;
    return {{change * change}};
  }
};

}  // namespace scree
