#pragma once
// Newton's method for a root that a good guess is known of.

#include <cmath>

#include "kernels/types.h"

namespace scree {

/// A function's value and derivative at a point.
struct ValueAndSlope {
  double value = 0;
  double slope = 0;
};

/// Improves a guess of a positive root until rounding stops it. Where that takes more than a few
/// steps or leads below zero, a bracketing method is the better one.
/// @param f     point to ValueAndSlope; values of order one, so that rounding is epsilon
/// @param root  in: a guess, positive; out: the root, or the last point
/// @return whether it converged
template <class F>
SCREE_HD bool newton_root(F f, double& root) {
  constexpr double epsilon = 2.3e-16;
  for (int k = 0; k < 8; ++k) {
    const ValueAndSlope at = f(root);
    if (std::abs(at.value) <= 4 * epsilon) return true;
    const double step = at.value / at.slope;
    if (!(step < root)) return false;  // not finite, or below zero
    root -= step;
    if (std::abs(step) <= 4 * epsilon * root) return true;
  }
  return false;
}

}  // namespace scree
