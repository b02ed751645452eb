#pragma once
// What the unaccelerated solvers share: parameters, velocities, and the loop of sweeps and checks.

#include <algorithm>

#include "kernels/solve/metric_step.h"
#include "solvers/residual.h"
#include "solvers/solver_card.h"

namespace scree {

/// Velocities; the metric of each contact.
inline HeldBytes relaxation_memory(const SolverCase& c) { return {c.twist(), 3 * c.real}; }

/// GaussSeidelPass over all contacts. Contact: normal 3R, bias R, ids 8, metric 3R, impulse 3R
/// read, 3R written. Body: twist 6R and inertia 2R read, twist 6R written: once each, or for
/// both bodies of each contact.
/// @param r  size of a number [bytes]
constexpr Traffic gauss_seidel_sweep_traffic(double r) {
  const double streamed = 13 * r + 8;
  return {streamed, 14 * r, streamed + 28 * r, 0};
}
static_assert(gauss_seidel_sweep_traffic(4).contact_least == 60);
static_assert(gauss_seidel_sweep_traffic(4).contact_requested == 60 + 64 + 48);

/// Base of Jacobi and of the Gauss-Seidel solvers. Their objective falls with every sweep, so the
/// last iterate is returned.
template <class B, class Real>
class RelaxationSolver : public Solver<B, Real> {
 public:
  explicit RelaxationSolver(const SolverParams& params) : params_(params) { validate(params_); }

 protected:
  Real relaxation() const { return static_cast<Real>(kRelaxation.of(params_.own)); }

  /// Projects the guess.
  /// @return V, valid for bodies that do not move; iterate() computes it for the others
  template <class R>
  Span<Twist<Real>> begin(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma) {
    ContactPasses<R, B, Real>::project_impulses(b, p, gamma);
    return this->start_velocity(b, p);
  }

  /// Repeats `sweep` until a check stops it. Before each check `collect` brings the impulses into
  /// `gamma` and V is gathered from them exactly: increments of V pile up rounding errors.
  template <class R, class Sweep, class Collect>
  SolveStats iterate(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance,
                     Span<Twist<Real>> velocity, Sweep sweep, Collect collect) {
    ResidualEvaluator<B, Real> residual(b);
    SolveStats stats;
    for (;;) {
      collect();
      ContactPasses<R, B, Real>::gather_velocities(b, p, gamma, velocity);
      this->update_ghosts(b, velocity);
      stats.residual = residual.template evaluate<R>(b, p, gamma, velocity);
      this->add_to_curve(stats.iterations, stats.applications, stats.residual.rms);
      stats.converged = stats.residual.rms <= tolerance;
      const bool is_finite = stats.residual.bad_contact < 0;
      if (stats.converged || !is_finite || stats.iterations >= params_.max_iterations) break;
      const int block = std::min(params_.check_every, params_.max_iterations - stats.iterations);
      for (int k = 0; k < block; ++k) sweep();
      stats.iterations += block;
      stats.applications += block;
    }
    stats.residual = residual.template evaluate_with_objective<R>(b, p, gamma, velocity);
    residual.template add_own<R>(b, p, gamma, velocity, stats.residual);
    return stats;
  }

 private:
  SolverParams params_;
};

}  // namespace scree
