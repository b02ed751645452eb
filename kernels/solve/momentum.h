#pragma once
// Momentum of accelerated methods: how far the next point is extrapolated beyond the iterate.

#include "kernels/types.h"

namespace scree {

/// Nesterov's parameter theta, at most 1, after one more iteration: 1 / theta grows by a third each
/// time. Nesterov's own rule, about a half, overshoots where contacts open and close.
inline SCREE_HD double next_theta(double theta) { return theta / (1 + theta / 3); }

/// The factor beta of y+ = x+ + beta (x+ - x) that goes with next_theta(theta).
inline SCREE_HD double next_beta(double theta) { return (1 - theta) / (1 + theta / 3); }

/// The theta of a solve that begins: that of one that runs for some iterations already.
/// The first ones are few against those that it takes, and waste none on gathering speed.
/// Cold starts gain as well.
inline constexpr double kFirstTheta = 0.25;

}  // namespace scree
