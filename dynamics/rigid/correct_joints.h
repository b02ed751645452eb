#pragma once
// Joints lie where they belong at the end of a step, as far as impulses can take them there. docs/theory.md, "Joints".

#include <algorithm>
#include <cmath>
#include <limits>

#include "dynamics/rigid/joints.h"
#include "host/scene.h"
#include "solvers/solver.h"

namespace scree {

struct JointCorrection {
  const Scene& scene;
  double tolerance = 0;    ///< of solves [m/s]
  double reference = 0;    ///< v*, see reference_speed() [m/s]
  double start_error = 0;  ///< of joints at the start of the step [m]
  double way_back = 0;     ///< longest of a point of a body to where limits are passed no more [m]
  /// On any rank: bodies that no joint holds may give energy to those of joints.
  bool has_contacts = false;
};

/// Solves the problem again as long as joints would not lie where they belong at the end of the step, and that helps. Where the
/// step makes errors worse instead, it does less about them, or nothing. Where joints contradict each other they give way. What
/// redundant ones bear they share in the end.
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
  // Times the energy of all bodies, as joined ones count once for each of their joints.
  constexpr double kAbsurd = 10;
  constexpr double kForced = 4;   // times v*: less makes up for what loads have slowed down
  constexpr double kLeft = 0.1;   // of what is asked for, where it is contradicted
  constexpr double kGive = 0.01;  // of the mobility of a joint
  const SteppingSettings& stepping = wanted.scene.stepping;
  const double enough = std::max(kNear, 3 * stepping.time_step * wanted.tolerance);
  const auto solve_again = [&](bool is_warm) {
    keep();
    const SolveStats first = stats;
    joints.guess(b, bodies, problem, gamma, is_warm);
    stats = solver.solve(b, problem, gamma, wanted.tolerance);
    stats.iterations += first.iterations;
    stats.applications += first.applications;
  };
  const bool has_guess = wanted.scene.solver.warm_start;
  joints.keep_plan(b);
  auto end = at_end();
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds && stats.converged; ++round) {
    if (!(end.missed > enough && end.missed < kProgress * before)) break;
    before = end.missed;
    solve_again(has_guess);
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
  const double pulled = speed_for(wanted.start_error);
  const double back = std::sqrt(kMostGain) * speed_for(wanted.way_back);
  const double recovery = std::max(pulled, back);
  const double allowed = kMostGain * end.free_energy + 0.5 * end.mass * recovery * recovery;
  const auto solve_for = [&](double share) {
    joints.plan(b, bodies, share, /*give=*/0, gamma);
    solve_again(has_guess);
    end = at_end();
  };
  const auto do_less = [&] {
    const auto planned = end;
    solve_for(0);
    const auto at_rest = end;
    const auto is_fine = [&](const auto& at) {
      return at.error <= std::max(error, at_rest.error) &&
             at.speed <= kWorse * at_rest.speed + speed &&
             at.energy <= std::max(allowed, kMostGain * at_rest.energy);
    };
    if (is_fine(planned)) return solve_for(1);
    solve_for(kSmallShare);
    if (is_fine(end)) return;
    // Contacts have impulses of what was no good: a solver that goes on from absurd ones may stay with them.
    fill(b, gamma, Vec3<Real>{});
    solve_for(0);
  };
  if (!(end.error <= error && end.speed <= kWorse * end.speed_before + speed &&
        end.energy <= allowed))
    do_less();

  // A motor that nothing bounds, or a prescribed body, against joints or contacts that do not let it: no velocities do what all ask
  // for, or absurd ones do, as of bodies that spin so fast that anchors that are apart go where the motor wants them. So the rows of
  // all joints give way by a part of their impulses: velocities are those of the least squares of what is left, but for that part.
  const double asked = recovery + end.driven;
  // In terms of speeds: what drives give adds to what there is.
  const bool is_too_fast = std::sqrt(end.energy) > std::sqrt(kMostGain * end.free_energy) +
                                                       std::sqrt(0.5 * end.mass) * asked;
  const bool is_forced = end.forced > kForced * wanted.reference;
  const bool is_left = is_forced && end.left > kLeft * (pulled + end.forced);
  // What hits joined bodies gives them no more energy than all bodies have.
  const auto is_absurd = [&] {
    const FreeMotion all = joints.free_motion(b, bodies, problem);
    const double given = asked + all.prescribed;
    return end.energy > kAbsurd * (all.energy + 0.5 * end.mass * given * given);
  };
  const auto is_by_contacts = [&] {
    return wanted.has_contacts && !is_forced && !(end.forced > 0 && is_absurd());
  };
  const bool gives_way =
      stats.converged ? is_too_fast && !is_by_contacts() : is_too_fast || is_left;
  if (!gives_way) return joints.share(b, bodies, problem, gamma, solver.velocity());
  fill(b, gamma, Vec3<Real>{});
  joints.plan(b, bodies, /*share=*/1, kGive, gamma);
  solve_again(/*is_warm=*/false);  // a guess takes rows to be firm
}

}  // namespace scree
