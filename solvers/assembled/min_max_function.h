#pragma once
// The equations of box friction with coupled bounds, |r_t1|, |r_t2| <= mu r_n, in min-max form: on
// the host and on a device.

#include <algorithm>

#include "solvers/assembled/contact_function.h"

namespace scree {

/// Row by row, with rho the inverse diagonal entry of the contact's block:
///   F_n = min(r_n, rho_n u_n),   F_t = max(r_t - mu r_n, min(r_t + mu r_n, rho_t u_t))
/// Bounds of a negative r_n are zero. Each is the middle one of three terms, so a row of
/// the Jacobian is one of W or has one or two entries: once the right terms are picked
/// a Newton step is exact.
/// Source: Ortiz-Rosado, PhD thesis, University of Iowa, 2007, as described by Preclik, Iglberger
/// and Ruede, Iterative rigid multibody dynamics, 2009.
struct MinMaxFunction {
  static constexpr const char* other_law = "box friction";

  /// @param W      diagonal block [1/kg]
  /// @param scale  of contact_scales
  SCREE_HD ContactFunction operator()(double mu, const Block3& W, double scale, const double* r,
                                      const double* u) const {
    ContactFunction f{};
    double rho[3];
    for (int i = 0; i < 3; ++i) rho[i] = 1 / std::max(W[4 * i], 1e-6 * scale);
    if (r[0] <= rho[0] * u[0]) {
      f.value[0] = r[0];
      f.by_r[0] = 1;
    } else {
      f.value[0] = rho[0] * u[0];
      f.by_u[0] = rho[0];
    }
    const double bound = mu * std::max(0.0, r[0]), slope = r[0] > 0 ? mu : 0;
    for (int i = 1; i < 3; ++i) {
      const double above = r[i] - bound, below = r[i] + bound, still = rho[i] * u[i];
      f.value[i] = std::max(above, std::min(below, still));
      if (still > above && still < below) {
        f.by_u[4 * i] = rho[i];
      } else {
        f.by_r[4 * i] = 1;
        f.by_r[3 * i] = still <= above ? -slope : slope;
      }
    }
    return f;
  }
};

}  // namespace scree
