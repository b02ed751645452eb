#pragma once
// How stiff contacts are taken for in the first Newton steps of a minimization.
//
// Near contact a barrier is nearly a logarithm: its force f grows as 1/g with the gap g, its curvature is f/g, and out of a gap that
// is far too small Newton's method goes g at a time, which doubles it. Where the contact is to end with a force l < f, a curvature
// of l/g leads there in one step. Primal-dual methods do so with multipliers as l (Nocedal and Wright, Numerical Optimization,
// section 19.3); here it is at least the force at the start, which may double in each step, that at a tenth of the reach, and a part
// of f that doubles too: after six steps the curvature is that of the barrier. The gradient always is.

#include <cmath>

#include "kernels/affine/barrier.h"

namespace scree::affine {

struct ExpectedForces {
  double growth = 1;  ///< over the force at the start
  double least = 1;   ///< over the force that is there now; 1: nothing less than that is expected

  /// Those of a Newton step, of which the first has the number 0.
  static ExpectedForces in_step(int iteration) {
    if (iteration == 0 || iteration >= kSteps) return {};
    const double growth = std::ldexp(1, iteration);
    return {growth, std::ldexp(1, iteration - kSteps)};
  }

  /// Whether less may be expected at such a distance than the force that is there.
  SCREE_HD bool may_have_surplus(const Barrier& barrier, double squared) const {
    const double low = low_distance(barrier);
    return least < 1 && squared < low * low;
  }
  /// Part of the force that is more than what is expected. @param squared  of the distance now  @param at_start  and at the start [m^2]
  SCREE_HD double surplus(const Barrier& barrier, double squared, double at_start) const {
    const double low = low_distance(barrier);
    const double now = force(barrier, squared), at_low = force(barrier, low * low);
    double expected = growth * force(barrier, at_start);
    expected = expected > at_low ? expected : at_low;
    expected = expected > least * now ? expected : least * now;
    return expected < now ? 1 - expected / now : 0;
  }

 private:
  static constexpr int kSteps = 6;
  static constexpr double kLow = 0.1;  ///< gap, over the reach, whose force is always expected

  static SCREE_HD double low_distance(const Barrier& barrier) {
    return barrier.separation + kLow * barrier.reach;
  }
  static SCREE_HD double force(const Barrier& barrier, double squared) {
    return -2 * barrier(squared).first * std::sqrt(squared);
  }
};

}  // namespace scree::affine
