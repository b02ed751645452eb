#pragma once
// Root of a continuous function between two points at which its signs differ.

#include <cmath>

#include "kernels/types.h"

namespace scree {

/// Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection, until
/// the bracket is as narrow as rounding allows. @param fa, fb  f(a) and f(b), of different signs
/// Source: Chandrupatla, Advances in Engineering Software 28, 1997.
template <class F>
SCREE_HD double bracketed_root(F f, double a, double fa, double b, double fb) {
  constexpr double epsilon = 2.3e-16;
  double t = 0.5;
  for (int k = 0; k < 200; ++k) {
    const double x = a + t * (b - a);
    const double fx = f(x);
    double c = a, fc = fa;
    if ((fx > 0) == (fa > 0)) {
      c = a;
      fc = fa;
    } else {
      c = b;
      fc = fb;
      b = a;
      fb = fa;
    }
    a = x;
    fa = fx;
    const bool a_is_best = std::abs(fa) < std::abs(fb);
    const double best = a_is_best ? a : b;
    const double width = std::abs(b - a);
    const double least = 2 * epsilon * std::abs(best) + 1e-300;
    const double t_least = least / width;
    if (!(t_least < 0.5) || fa == 0) return fa == 0 ? a : best;
    const double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
    if (phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi) {
      t = fa / (fb - fa) * (fc / (fb - fc)) +
          (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb));
    } else {
      t = 0.5;
    }
    t = std::fmin(1 - t_least, std::fmax(t_least, t));
  }
  return a;
}

}  // namespace scree
