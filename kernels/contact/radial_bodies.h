#pragma once
// Which bodies touch each other radially, and the unit of their angular rates in a contact problem.

#include "kernels/bodies/body_view.h"
#include "kernels/bodies/locks.h"
#include "kernels/contact/contact_problem.h"
#include "kernels/math/scalar.h"

namespace scree {

/// Whether contacts of two such bodies are radial: free spheres that turn about all axes or none,
/// and fixed and kinematic bodies that do not turn in this step.
template <class Real>
SCREE_HD bool is_radial_body(const BodyView<Real>& bodies, Index i) {
  if (bodies.is_fixed(i)) return is_zero(norm2(bodies.angular_velocity[i]));
  const unsigned locks = bodies.locks[i], turning = free_angular_axes(locks);
  return bodies.shape[i] < 0 && free_linear_axes(locks) == 7u && (turning == 7u || turning == 0u);
}

/// Length by which the angular rate of a body is multiplied in a problem of this layout [m]: see
/// ContactProblem.
template <class Real>
SCREE_HD Real rate_length(ContactLayout layout, const BodyView<Real>& bodies, Index i) {
  if (layout == ContactLayout::radial) return bodies.radius[i];
  const bool is_scaled =
      layout == ContactLayout::mixed && bodies.moves(i) && is_radial_body(bodies, i);
  return is_scaled ? bodies.radius[i] : Real(1);
}

/// Rates of owned bodies from those of a problem of the mixed layout.
template <class Real>
struct PlainRates {
  static constexpr const char* name = "plain_rates";
  BodyView<Real> bodies;
  Span<const Twist<Real>> solved;
  Span<Twist<Real>> plain;  ///< [owned_count] out
  SCREE_HD void operator()(Index i) const {
    const Real length = rate_length(ContactLayout::mixed, bodies, i);
    plain[i] = {solved[i].linear, (Real(1) / length) * solved[i].angular};
  }
};

/// The lengths of all bodies in the mixed layout.
template <class Real>
struct RateLengths {
  static constexpr const char* name = "rate_lengths";
  BodyView<Real> bodies;
  Span<Real> length;  ///< out [m]
  SCREE_HD void operator()(Index i) const {
    length[i] = rate_length(ContactLayout::mixed, bodies, i);
  }
};

}  // namespace scree
