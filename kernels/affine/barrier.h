#pragma once
// The barrier that keeps surfaces apart, as a function of their squared distance.
// Source: Li et al., Incremental Potential Contact, ACM TOG 39(4), 2020; the form in units of
// pressure: Li et al., Convergent Incremental Potential Contact, 2023. docs/theory.md, "Barrier contact".

#include <cmath>

#include "kernels/types.h"

namespace scree::affine {

enum class BarrierForm : std::uint8_t {
  original,  ///< b = -(y - s)^2 ln(y / s) [m^4]
  physical   ///< the same times reach / s^2 [m]: weights are areas, the stiffness a pressure
};

/// A value and its derivatives with respect to the squared distance D.
struct Derivatives {
  double value = 0;
  double first = 0;
  double second = 0;
};

/// y = D - separation^2 and s = (2 separation + reach) reach, so that the barrier acts from a
/// distance of separation + reach on and is infinite at the separation.
struct Barrier {
  double stiffness = 1;   ///< kappa: [Pa] in the physical form, [J/m^4] in the original one, > 0
  double reach = 1e-3;    ///< d_hat [m], > 0
  double separation = 0;  ///< xi [m], >= 0
  BarrierForm form = BarrierForm::original;

  SCREE_HD double support() const { return (2 * separation + reach) * reach; }
  /// Whether a pair at this squared distance feels the barrier.
  SCREE_HD bool acts(double squared) const { return squared - separation * separation < support(); }
  /// The barrier with its stiffness. At and below the separation the value is infinite.
  SCREE_HD Derivatives operator()(double squared) const {
    Derivatives r;
    if (!acts(squared)) return r;
    const double s = support(), y = squared - separation * separation;
    if (!(y > 0)) {
      r.value = HUGE_VAL;
      return r;
    }
    const double scale = stiffness * (form == BarrierForm::physical ? reach / (s * s) : 1);
    const double below = y - s, log = std::log(y / s), ratio = below / y;
    r.value = -scale * below * below * log;
    r.first = -scale * below * (2 * log + ratio);
    r.second = -scale * (2 * log + ratio * (4 - ratio));
    return r;
  }
};

}  // namespace scree::affine
