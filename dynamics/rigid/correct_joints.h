#pragma once
// Joints lie where they belong at the end of a step, as far as impulses can take them there. docs/theory.md, "Joints".

#include <algorithm>
#include <limits>

#include "dynamics/rigid/joints.h"
#include "host/scene.h"
#include "solvers/solver.h"

namespace scree {

struct JointCorrection {
  const Scene& scene;
  double tolerance = 0;    ///< of solves [m/s]
  double start_error = 0;  ///< of joints at the start of the step [m]
  double way_back = 0;     ///< longest of a point of a body to where limits are passed no more [m]
};

/// Solves the problem again as long as joints would not lie where they belong at the end of the step, and that helps. Where the
/// step makes errors worse instead, it does less about them, or nothing.
/// @param at_end  gives Joints::AtEnd of the last solve, and corrects the rows by what was missed
/// @param keep    keeps the biases of a problem that is about to be solved
template <class B, class Real, class AtEnd, class Keep>
void correct_joints(B& b, Joints<B, Real>& joints, const BodyView<Real>& bodies,
                    Solver<B, Real>& solver, const ContactProblem<Real>& problem,
                    Span<Vec3<Real>> gamma, const JointCorrection& wanted, SolveStats& stats,
                    AtEnd at_end, Keep keep) {
  constexpr int kMostRounds = 4;
  constexpr double kNear = 1e-7;     // [m]
  constexpr double kProgress = 0.5;  // an error that falls less is not for impulses to take away
  constexpr double kWorse = 2, kMostMissed = 10, kMostRecoveries = 20, kSmallShare = 1.0 / 16;
  constexpr double kMostGain = 1.2;  // of energy in a step
  const SteppingSettings& stepping = wanted.scene.stepping;
  const double enough = std::max(kNear, 3 * stepping.time_step * wanted.tolerance);
  const auto solve_again = [&] {
    keep();
    const SolveStats first = stats;
    joints.guess(b, bodies, problem, gamma, wanted.scene.solver.warm_start);
    stats = solver.solve(b, problem, gamma, wanted.tolerance);
    stats.iterations += first.iterations;
    stats.applications += first.applications;
  };
  joints.keep_plan(b);
  auto end = at_end();
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds && stats.converged; ++round) {
    if (!(end.missed > enough && end.missed < kProgress * before)) break;
    before = end.missed;
    solve_again();
    end = at_end();
  }
  // Bodies go no faster for errors than a few times the recovery speed, which many joints in a row add up to.
  const double error = kWorse * wanted.start_error + kMostMissed * enough;
  const double speed = kMostRecoveries * stepping.max_recovery_speed;
  // Nor with more energy than the errors at the start account for: where a chain lies in a straight line, what moves across is pulled
  // back to the line in each step, faster and faster. Drives and what is prescribed add energy without errors, too.
  const auto speed_for = [&](double way) {
    return std::min(way / stepping.time_step, stepping.max_recovery_speed);
  };
  const double pulled = speed_for(wanted.start_error), back = speed_for(wanted.way_back);
  const double allowed = kMostGain * end.free_energy +
                         0.5 * end.mass * std::max(pulled * pulled, kMostGain * back * back);
  if (end.error <= error && end.speed <= kWorse * end.speed_before + speed && end.energy <= allowed)
    return;
  const auto planned = end;
  const auto solve_for = [&](double share) {
    joints.plan(b, bodies, share, gamma);
    solve_again();
    end = at_end();
  };
  solve_for(0);
  const auto at_rest = end;
  const auto is_fine = [&](const auto& at) {
    return at.error <= std::max(error, at_rest.error) &&
           at.speed <= kWorse * at_rest.speed + speed &&
           at.energy <= std::max(allowed, kMostGain * at_rest.energy);
  };
  if (is_fine(planned)) return solve_for(1);
  solve_for(kSmallShare);
  if (!is_fine(end)) solve_for(0);
}

}  // namespace scree
