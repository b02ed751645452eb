#pragma once
// The contact passes that move the shift of the De Saxce fixed point: between two convex solves,
// and within one.

#include "kernels/solve/apgd_passes.h"

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
    if constexpr (R::kHasJoints) {
      if (R::is_joint(p, c)) return {};
    }
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

/// Lets the shift of a running solve follow: bias[c] = original bias + lift[c]. A sliding contact
/// moves it a part of the way only, so that solving goes on undisturbed while it settles. One that
/// sticks has none, whatever speed the iterate still has there, and that of one without an impulse
/// changes nothing. Bytes per contact (radial, float): impulse, normal, ids 32, bias and lift 8
/// read, two twists 48 gathered, 8 written.
template <class R, class Real>
struct FollowLift {
  static constexpr const char* name = "follow_lift";
  static constexpr double kShare = 0.4;  ///< of the way, where the contact goes on sliding
  ContactProblem<Real> p;                ///< the original problem
  ApgdImpulses<Real> gamma;
  ApgdVelocities<Real> velocity;
  const ApgdState* state;
  Span<Real> lift;  ///< [m/s]
  Span<Real> bias;  ///< [m/s]
  bool is_first;    ///< there was no lift before

  SCREE_HD void operator()(Index c) const {
    const Span<const Twist<Real>> v = velocity.current(*state);
    const auto u = R::velocity(p, c, v[p.body_a[c]], v[p.body_b[c]]);
    const auto g = R::load(gamma.current(state->accepted), c);
    const Real target = is_sticking(p, c, g) ? Real(0) : de_saxce_shift(p, c, u);
    const bool slides = target > Real(0) && dot(g, g) > Real(0) && !is_first;
    lift[c] = slides ? lift[c] + static_cast<Real>(kShare) * (target - lift[c]) : target;
    bias[c] = p.bias[c] + lift[c];
  }
};

}  // namespace scree
