#pragma once
// Exact Coulomb friction: APGD on the law itself, and the De Saxce fixed point around any solver of
// the convex problem.
//
// APGD takes steps with the projection onto the disk that the normal impulse leaves in place of the
// one onto the cone. An iteration costs what one of the convex problem does, and a settled bed
// takes 1.3 to 1.6 times as many. That they converge is not proven, and where friction is high they
// may not. Whatever they leave undone, and all solvers but APGD, go the way of the fixed point:
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
  /// @param direct                solver of the exact problem that goes first, or none
  /// @throws InvalidParameter
  CoulombFixedPoint(std::unique_ptr<Solver<B, Real>> inner, int max_outer_iterations,
                    std::unique_ptr<Solver<B, Real>> direct = nullptr)
      : inner_(std::move(inner)),
        direct_(std::move(direct)),
        max_outer_iterations_(max_outer_iterations) {
    if (!inner_) throw InvalidParameter("solver.coulomb needs an inner solver, got none");
    if (max_outer_iterations_ <= 0) {
      throw InvalidParameter("solver.max_outer_iterations must be positive, got " +
                             std::to_string(max_outer_iterations_));
    }
  }

  /// `converged` is judged on the exact residual; both residuals are of the original problem.
  SolveStats solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                   double tolerance) override {
    SolveStats first;
    if (direct_) {
      first = solve_directly(b, p, gamma, tolerance);
      if (first.converged || first.residual.bad_contact >= 0) return first;
    }
    Buffer<B, Vec3<Real>> found(b, direct_ ? gamma.size : 0);
    if (direct_) copy(b, Span<const Vec3<Real>>(gamma), found.view());
    return with_rows<Real>(p.layout, [&](auto rows) {
      using R = decltype(rows);
      SolveStats stats = run<R>(b, p, gamma, tolerance, first);
      if (direct_ && !(stats.residual.exact_rms < first.residual.exact_rms)) {
        copy(b, Span<const Vec3<Real>>(found.view()), gamma);
        stats.residual = result_of<R>(b, p, gamma);
      }
      return stats;
    });
  }

  std::vector<double> memory() const override {
    std::vector<double> all = direct_ ? direct_->memory() : std::vector<double>{};
    for (const double value : inner_->memory()) all.push_back(value);
    return all;
  }
  void restore_memory(const std::vector<double>& m) override {
    const std::size_t own = direct_ ? std::min(m.size(), direct_->memory().size()) : 0;
    const auto middle = m.begin() + static_cast<std::ptrdiff_t>(own);
    if (direct_) direct_->restore_memory({m.begin(), middle});
    inner_->restore_memory({middle, m.end()});
  }
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

  /// Rounds of the direct solver, as long as they help.
  SolveStats solve_directly(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                            double tolerance) {
    SolveStats all;
    for (int round = 0; round < max_outer_iterations_; ++round) {
      const double before = all.residual.exact_rms;
      const SolveStats stats = direct_->solve(b, p, gamma, tolerance);
      all.iterations += stats.iterations;
      all.applications += stats.applications;
      all.converged = stats.converged;
      all.residual = stats.residual;
      this->add_to_curve(all.iterations, all.applications, all.residual.exact_rms);
      if (all.converged || all.residual.bad_contact >= 0) break;
      if (round > 0 && !(all.residual.exact_rms < kProgress * before)) break;
    }
    this->take_velocity(*direct_);
    return all;
  }

  /// @param first  what was done before on the same problem
  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance,
                 const SolveStats& first) {
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
    stats.iterations = first.iterations;
    stats.applications = first.applications;
    stats.residual = w.residual.template evaluate<R>(b, p, gamma, velocity);
    this->add_to_curve(stats.iterations, stats.applications, stats.residual.exact_rms);
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

  /// Residual of given impulses, and their velocities.
  template <class R>
  Residual result_of(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma) {
    const Span<Twist<Real>> velocity = this->start_velocity(b, p);
    for_each(b, p.free_count, BodyVelocity<R, Real>{p, gamma, velocity});
    ResidualEvaluator<B, Real> residual(b);
    return residual.template evaluate_with_objective<R>(b, p, gamma, velocity);
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
  /// A round of the direct solver that leaves more than that of the residual is its last.
  static constexpr double kProgress = 0.9;

  std::unique_ptr<Solver<B, Real>> inner_, direct_;
  int max_outer_iterations_;
};

/// Solver of the exact problem by the name of one of the convex problem.
/// @param params  max_iterations is the most of APGD's own iterations and of each convex solve
/// @throws InvalidParameter
template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_exact_solver(const std::string& name, SolverParams params,
                                                   int max_outer_iterations) {
  params.exact_coulomb = false;
  auto inner = make_solver<B, Real>(name, params);
  std::unique_ptr<Solver<B, Real>> direct;
  if (name == "apgd") {
    params.exact_coulomb = true;
    direct = make_solver<B, Real>(name, params);
  }
  return std::make_unique<CoulombFixedPoint<B, Real>>(std::move(inner), max_outer_iterations,
                                                      std::move(direct));
}

}  // namespace scree
