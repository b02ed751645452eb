#pragma once
// What led bodies do to others in a step: whether they squeeze one, and whether they came to where they should be.

#include <algorithm>
#include <vector>

#include "dynamics/affine/affine_setup.h"
#include "dynamics/affine/led_motion.h"
#include "dynamics/affine/push_islands.h"
#include "dynamics/model_on.h"
#include "kernels/affine/step_programs.h"

namespace scree::affine {

template <class B>
class LedPush {
 public:
  /// @param setup, led  are kept by reference
  LedPush(B& b, const AffineSetup& setup, const LedMotion& led)
      : b_(&b), setup_(&setup), led_(&led) {}

  /// Whether a body is squeezed more than it may be. One that is blocked gives way until that: where led bodies go parts of steps it
  /// is little, since these end wherever that is reached.
  /// @param start, end  states by body
  bool squeezes(const Potential& p, Span<const AffineVec> start, Span<const AffineVec> end) {
    const double most = led_->is_slow() ? std::clamp(largest_strain(p, start, kSlowSqueeze),
                                                     kSlowSqueeze, kMostSqueeze)
                                        : kMostSqueeze;
    return largest_strain(p, end, most) > most;
  }

  /// Led bodies that are not where they should be. @param tolerance  [m]
  int count_missed(const Potential& p, Span<const AffineVec> q, double tolerance) {
    return static_cast<int>(
        reduce_to_host<Sums<1>>(
            *b_, p.rows(), MissedTargets{p.bodies, p.body_of_row, p.start, q, p.target, tolerance})
            .value[0]);
  }

 private:
  /// Strain from which on a body counts as squeezed: where led bodies go whole steps, and where they go parts.
  static constexpr double kMostSqueeze = 0.01, kSlowSqueeze = 0.001;

  /// Of a body that led ones may push, or that of any where it is small. @param small  what counts as that
  double largest_strain(const Potential& p, Span<const AffineVec> q, double small) {
    const double of_all =
        reduce_to_host<Largest<double>>(*b_, p.rows(), StrainOfRow{p.bodies, p.body_of_row, q})
            .value;
    if (!(of_all > small)) return of_all;
    const std::vector<bool> is_near = bodies_near_led(*setup_, download(*b_, p.near.bodies));
    const std::vector<AffineVec> state = download(*b_, q);
    double most = 0;
    for (std::size_t body = 0; body < state.size(); ++body)
      if (is_near[body] && !setup_->bodies[body].lame.is_elastic())
        most = std::max(most, strain_norm(state[body]));
    return most;
  }

  B* b_;
  const AffineSetup* setup_;
  const LedMotion* led_;
};

}  // namespace scree::affine
