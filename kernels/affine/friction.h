#pragma once
// Smoothed friction of one pair, with its tangents, weights and normal force of an earlier state.
// Source: Li et al., ACM TOG 39(4), 2020, section 5.4. docs/theory.md, "Barrier contact".

#include <cmath>

#include "kernels/affine/nearest.h"

namespace scree::affine {

/// A pair as friction remembers it.
struct FrictionContact {
  double weight[4] = {};  ///< of the four points, as in Nearest
  Vec3d tangent[2];       ///< orthonormal
  double bound = 0;       ///< mu times the normal force [N]
};

/// @param n      nearest points at the earlier state, apart. @param force  normal force there [N]
SCREE_HD inline FrictionContact friction_contact(const Nearest& n, double mu, double force) {
  FrictionContact f;
  for (int i = 0; i < 4; ++i) f.weight[i] = n.weight[i];
  const Vec3d normal = normalized(n.gap);
  f.tangent[0] = any_orthogonal(normal);
  f.tangent[1] = cross(normal, f.tangent[0]);
  f.bound = mu * force;
  return f;
}

/// Energy of a slip by y under a unit bound: f0, whose derivative f1 grows from 0 to 1 over the
/// length `slip` and stays there.
struct SlipLaw {
  double slip = 1e-5;  ///< speed below which contacts count as sticking, times the step [m]; > 0
  double damping = 0;  ///< of Newton steps along the slip, over f1/y

  SCREE_HD double energy(double y) const {
    if (y >= slip) return y;
    const double r = y / slip;
    return slip * (r * r * (1 - r / 3) + 1.0 / 3);
  }
  /// f1(y) / y, also for y = 0.
  SCREE_HD double force_per_slip(double y) const {
    return y >= slip ? 1 / y : (2 - y / slip) / slip;
  }
  /// How much a Newton step changes a slip that may come to stick or to slide, over `slip`; zero where that is known. As f1 is
  /// 2 r - r^2 with r = y / slip, a step by d leaves a force of d^2, and the next one is d^2 / (2 (1 - r)): a contact that stays below
  /// 1 with twice that sticks.
  SCREE_HD double undecided(double before, double after, double change) const {
    if (before >= slip && after >= slip) return 0;
    const double r = after / slip, d = change / slip;
    if (before < slip && after < slip && r + d * d / (1 - r) < 1) return 0;
    return d;
  }
  /// f1'(y).
  SCREE_HD double stiffness(double y) const { return y >= slip ? 0 : 2 * (1 - y / slip) / slip; }
  /// f1', or what damping asks for.
  SCREE_HD double damped_stiffness(double y) const {
    const double own = stiffness(y), least = damping * force_per_slip(y);
    return own > least ? own : least;
  }
};

/// How far the points of the pair slipped, in tangents. @param moved  displacements since the start
/// of the step [m]
SCREE_HD inline void slip_of(const FrictionContact& f, const Four& moved, double (&u)[2]) {
  Vec3d sum;
  for (int i = 0; i < 4; ++i) sum += f.weight[i] * moved[i];
  u[0] = dot(f.tangent[0], sum);
  u[1] = dot(f.tangent[1], sum);
}

SCREE_HD inline double friction_energy(const FrictionContact& f, const SlipLaw& law,
                                       const Four& moved) {
  double u[2];
  slip_of(f, moved, u);
  return f.bound * law.energy(std::sqrt(u[0] * u[0] + u[1] * u[1]));
}

SCREE_HD inline Four friction_gradient(const FrictionContact& f, const SlipLaw& law,
                                       const Four& moved) {
  double u[2];
  slip_of(f, moved, u);
  const double scale = f.bound * law.force_per_slip(std::sqrt(u[0] * u[0] + u[1] * u[1]));
  const Vec3d force = (scale * u[0]) * f.tangent[0] + (scale * u[1]) * f.tangent[1];
  Four g;
  for (int i = 0; i < 4; ++i) g[i] = f.weight[i] * force;
  return g;
}

}  // namespace scree::affine
