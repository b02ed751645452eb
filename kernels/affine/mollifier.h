#pragma once
// A factor for the barrier of two edges that goes to zero, with its slope, as they become parallel:
// their distance has a kink there. Source: Li et al., ACM TOG 39(4), 2020, section 5.2.

#include "kernels/affine/nearest.h"

namespace scree::affine {

/// Below this |e x f|^2 [m^4] the factor is less than one. @param e, f  the edges at rest
SCREE_HD inline double mollifier_threshold(const Vec3d& e, const Vec3d& f) {
  return 1e-3 * norm2(e) * norm2(f);
}

/// The factor of the edges (x[0], x[1]) and (x[2], x[3]) and its derivatives with respect to
/// c = |e x f|^2.
struct Mollifier {
  double value = 1;
  double first = 0;
  double second = 0;
};

SCREE_HD inline Mollifier mollifier(double threshold, const Four& x) {
  const double c = norm2(cross(x[1] - x[0], x[3] - x[2]));
  Mollifier m;
  if (c >= threshold) return m;
  const double r = c / threshold;
  m.value = (2 - r) * r;
  m.first = 2 * (1 - r) / threshold;
  m.second = -2 / (threshold * threshold);
  return m;
}

/// Gradient of c with respect to the four points.
SCREE_HD inline Four cross_gradient(const Four& x) {
  const Vec3d e = x[1] - x[0], f = x[3] - x[2];
  const double ee = norm2(e), ff = norm2(f), ef = dot(e, f);
  const Vec3d by_e = 2.0 * (ff * e - ef * f), by_f = 2.0 * (ee * f - ef * e);
  Four g;
  g[0] = -by_e, g[1] = by_e, g[2] = -by_f, g[3] = by_f;
  return g;
}

}  // namespace scree::affine
