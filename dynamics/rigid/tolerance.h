#pragma once
// When the solver of a step may stop. docs/theory.md, section "Residual".

#include <algorithm>
#include <cmath>

#include "host/scene.h"
#include "kernels/step/loads.h"
#include "kernels/step/step_setup.h"

namespace scree {

/// v*: the speed loads give a body in one step (RMS), without any that which motors would give, else that at which touching
/// bodies approach [m/s].
/// @param loads         null: gravity alone
/// @param gravity_step  h g [m/s]
/// @param motors        see motor_speed() [m/s]
inline double reference_speed(const LoadSums* loads, const Vec3d& gravity_step, double motors,
                              const SetupSums& sums, Index owned_count) {
  const double speed = loads != nullptr
                           ? std::sqrt(loads->squares / std::max<Index>(owned_count, 1))
                           : norm(gravity_step);
  if (speed > 0) return speed;
  if (motors > 0) return motors;
  return sums.touching > 0 ? std::sqrt(sums.approach_squares / sums.touching) : 0;
}

/// Largest coefficient of friction, rolling and spinning ones over a radius; 1 where friction is convex.
inline double steepest_friction(const Scene& scene, double diameter) {
  double most = 1;
  if (!scene.solver.exact_coulomb) return most;
  for (const Material& pair : all_pair_values(scene))
    most = std::max({most, pair.friction, 2 * pair.rolling_friction / diameter,
                     2 * pair.spinning_friction / diameter});
  return most;
}

/// RMS residual at which the solver stops [m/s].
/// @param reference  v* [m/s]
/// @param diameter   median of the free bodies [m]
/// @param steepest   with exact friction the largest coefficient: the residual of a contact that slides is what it is short of
///                   its gap, over that. Beyond 10 the levels follow it; below they bound overlaps well enough
inline double residual_tolerance(const StopRule& stop, double reference, double diameter,
                                 double time_step, double steepest) {
  const double length = diameter / time_step;
  const auto level = [&](double speed, double depth) {
    const double most =
        reference > 0 ? std::min(speed * reference, depth * length) : depth * length;
    constexpr double kSteep = 10;
    return most / std::max(steepest / kSteep, 1.0);
  };
  switch (stop.level) {
    case StopRule::Level::quality:
      return level(0.01, 3e-5);
    case StopRule::Level::preview:
      return level(0.03, 1e-4);
    case StopRule::Level::absolute:
      return stop.residual;
    case StopRule::Level::fixed_iterations:
      break;
  }
  return 0;
}

}  // namespace scree
