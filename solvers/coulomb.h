#pragma once
// Exact Coulomb friction: the De Saxce fixed point around any solver of the convex problem.
//
// A sliding contact of the convex problem lifts off at mu |u_t|. Adding that speed to the bias and
// solving again, until it no longer changes, gives Coulomb's law: gamma in K, u + mu |u_t| n in K*,
// orthogonal. One slipping contact with k = N_tt / N_nn contracts by k mu^2 / (1 + k mu^2) per
// outer iteration. Contacts that work against each other can make the plain iteration cycle:
// Aitken's relaxation (B. M. Irons & R. C. Tuck, Int. J. Numer. Meth. Engng 1, 1969) then shortens
// its steps. Source: De Saxce & Feng, Math. Comput. Modelling 28, 1998; docs/theory.md, section
// "Residual". Memory passes per outer iteration: those of the inner solve, and three over contacts.

#include <algorithm>
#include <string>
#include <utility>

#include "kernels/coulomb_pass.h"
#include "solvers/residual.h"

namespace scree {

/// The recorded curve holds the exact residual after each outer iteration, over the work of all
/// inner ones.
template <class B, class Real>
class CoulombFixedPoint final : public Solver<B, Real> {
 public:
  /// @param inner                 solver of the convex problem; warm-started from one iteration to
  /// the next
  /// @param max_outer_iterations  [-], > 0
  /// @throws InvalidParameter
  CoulombFixedPoint(std::unique_ptr<Solver<B, Real>> inner, int max_outer_iterations)
      : inner_(std::move(inner)), max_outer_iterations_(max_outer_iterations) {
    if (!inner_) throw InvalidParameter("solver.coulomb needs an inner solver, got none");
    if (max_outer_iterations_ <= 0) {
      throw InvalidParameter("solver.max_outer_iterations must be positive, got " +
                             std::to_string(max_outer_iterations_));
    }
  }

  /// `converged` is judged on the exact residual; both residuals are of the original problem.
  SolveStats solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                   double tolerance) override {
    return with_rows<Real>(p.layout,
                           [&](auto rows) { return run<decltype(rows)>(b, p, gamma, tolerance); });
  }

  std::vector<double> memory() const override { return inner_->memory(); }
  void restore_memory(const std::vector<double>& m) override { inner_->restore_memory(m); }
  bool keeps_marks() const override { return inner_->keeps_marks(); }

 private:
  struct Workspace {
    Workspace(B& b, Index contacts)
        : shift(b, contacts), change(b, contacts), bias(b, contacts), sums(b, 1), residual(b) {}
    Buffer<B, Real> shift;
    Buffer<B, Real> change;
    Buffer<B, Real> bias;
    Buffer<B, ShiftSums> sums;
    ResidualEvaluator<B, Real> residual;
  };

  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance) {
    const Span<Twist<Real>> velocity = this->start_velocity(b, p);
    if (p.contact_count == 0) return {0, 0, true, {}};
    Workspace w(b, p.contact_count);
    const Span<Real> shift = w.shift.view(), change = w.change.view(), bias = w.bias.view();
    ContactProblem<Real> shifted = p;
    shifted.bias = ContactBias<Real>(bias);
    double relaxation = 1;
    // Moves the shift towards what the present velocities ask for; returns the RMS distance to it.
    const auto update_bias = [&](Span<const Vec3<Real>> guess) {
      reduce<ShiftSums>(b, p.contact_count, ShiftChange<R, Real>{p, velocity, shift, change, guess},
                        StoreResult<ShiftSums>{w.sums.data()});
      const ShiftSums sums = fetch(b, w.sums.data());
      relaxation = next_relaxation(relaxation, sums);
      for_each(b, p.contact_count,
               ShiftBias<Real>{static_cast<Real>(relaxation), p.bias, change, shift, bias});
      return std::sqrt(sums.change_squares / p.contact_count);
    };

    for_each(b, p.contact_count, ProjectImpulses<R, Real>{p, gamma});
    for_each(b, p.free_count, BodyVelocity<R, Real>{p, gamma, velocity});
    fill(b, shift, Real(0));
    fill(b, change, Real(0));
    // A contact with a guessed impulse probably goes on sliding as it does; any other starts from
    // the convex problem. Where Coulomb's law has several solutions, a cold start thus finds the
    // one next to it.
    update_bias(gamma);
    fill(b, change, Real(0));  // not a step of the fixed point

    SolveStats stats;
    stats.residual = w.residual.template evaluate<R>(b, p, gamma, velocity);
    this->add_to_curve(0, 0, stats.residual.exact_rms);
    for (int outer = 0; outer < max_outer_iterations_ && !stats.converged; ++outer) {
      if (stats.residual.bad_contact >= 0) break;
      // No use in solving a problem accurately whose bias is still far off.
      const double inner_tolerance =
          std::max(kShareOfTolerance * tolerance, kShareOfResidual * stats.residual.exact_rms);
      const SolveStats inner =
          inner_->solve(b, shifted, gamma, tolerance > 0 ? inner_tolerance : 0);
      copy(b, inner_->velocity(), velocity);
      inner_->forget_velocity();
      stats.iterations += inner.iterations;
      stats.applications += inner.applications;
      stats.colors = inner.colors;
      stats.residual = w.residual.template evaluate<R>(b, p, gamma, velocity);
      this->add_to_curve(stats.iterations, stats.applications, stats.residual.exact_rms);
      const double distance = update_bias({});
      stats.converged = stats.residual.exact_rms <= tolerance && distance <= tolerance;
    }
    stats.converged = stats.residual.exact_rms <= tolerance;
    stats.residual = w.residual.template evaluate_with_objective<R>(b, p, gamma, velocity);
    return stats;
  }

  /// Aitken's rule: the step that a secant through the last two changes would take. Between a
  /// sixteenth and the whole step: longer ones would overshoot where contacts begin to stick.
  static double next_relaxation(double last, const ShiftSums& sums) {
    if (sums.last_by_difference == 0) return last;  // no last change
    return std::clamp(-last * sums.last_by_difference / sums.difference_squares, 1.0 / 16, 1.0);
  }

  /// Of the tolerance that an inner solve may leave; many end just below theirs.
  static constexpr double kShareOfTolerance = 0.1;
  static constexpr double kShareOfResidual = 0.02;  ///< of the last exact residual

  std::unique_ptr<Solver<B, Real>> inner_;
  int max_outer_iterations_;
};

}  // namespace scree
