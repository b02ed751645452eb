#pragma once
// Exact Coulomb friction: APGD on the law itself, and the De Saxce fixed point around any solver of
// the convex problem.
//
// APGD takes steps with the projection onto the disk that the normal impulse leaves in place of the
// one onto the cone. An iteration costs what one of the convex problem does, and a settled bed
// takes 1.3 to 1.6 times as many. That they converge is not proven, and where friction is high and
// bodies land they do not: a few sliding contacts keep the others in motion. APGD then takes steps
// of the convex law while the shift follows slowly (FollowLift), in rounds as long as they help.
// Whatever is left undone, and all solvers but APGD, go the way of the fixed point:
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
#include <vector>

#include "kernels/solve/coulomb_pass.h"
#include "solvers/residual.h"
#include "solvers/solver_card.h"

namespace scree {

/// The recorded curve holds the exact residual after each outer iteration, over the work
/// of all inner ones.
template <class B, class Real>
class CoulombFixedPoint final : public Solver<B, Real> {
 public:
  /// @param inner                 solver of the convex problem; warm-started from one iteration to
  /// the next
  /// @param max_outer_iterations  [-], > 0
  /// @param direct                solvers of the exact problem that go first, one after the other
  /// @throws InvalidParameter
  CoulombFixedPoint(std::unique_ptr<Solver<B, Real>> inner, int max_outer_iterations,
                    std::vector<std::unique_ptr<Solver<B, Real>>> direct = {})
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
    if (!direct_.empty()) {
      first = solve_directly(b, p, gamma, tolerance);
      if (first.converged || first.residual.bad_contact >= 0) return first;
    }
    Buffer<B, Vec3<Real>> found(b, direct_.empty() ? 0 : gamma.size);
    if (!direct_.empty()) copy(b, Span<const Vec3<Real>>(gamma), found.view());
    return with_rows<Real>(p.layout, [&](auto rows) {
      using R = decltype(rows);
      SolveStats stats = run<R>(b, p, gamma, tolerance, first);
      if (!direct_.empty() && !(stats.residual.exact_rms < first.residual.exact_rms)) {
        copy(b, Span<const Vec3<Real>>(found.view()), gamma);
        stats.residual = result_of<R>(b, p, gamma);
      }
      return stats;
    });
  }

  std::vector<double> memory() const override {
    std::vector<double> all;
    for (const Solver<B, Real>* solver : solvers())
      for (const double value : solver->memory()) all.push_back(value);
    return all;
  }
  void restore_memory(const std::vector<double>& m) override {
    auto at = m.begin();
    for (Solver<B, Real>* solver : solvers()) {
      const auto own = std::min<std::ptrdiff_t>(
          static_cast<std::ptrdiff_t>(solver->memory().size()), m.end() - at);
      solver->restore_memory({at, at + own});
      at += own;
    }
  }
  bool keeps_marks() const override { return inner_->keeps_marks(); }
  void set_ghosts(const Ghosts<B>* ghosts) override {
    Solver<B, Real>::set_ghosts(ghosts);
    for (Solver<B, Real>* solver : solvers()) solver->set_ghosts(ghosts);
  }

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

  std::vector<Solver<B, Real>*> solvers() const {
    std::vector<Solver<B, Real>*> all;
    for (const auto& solver : direct_) all.push_back(solver.get());
    all.push_back(inner_.get());
    return all;
  }

  /// One round of each direct solver, and more of the last one as long as they help.
  SolveStats solve_directly(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                            double tolerance) {
    SolveStats all;
    Buffer<B, Vec3<Real>> best(b);
    double least = -1;
    for (const auto& solver : direct_) {
      const int rounds = solver == direct_.back() ? max_outer_iterations_ : 1;
      for (int round = 0, idle = 0; round < rounds && idle < kIdle; ++round) {
        const SolveStats stats = solver->solve(b, p, gamma, tolerance);
        const double rms = stats.residual.exact_rms;
        all.iterations += stats.iterations;
        all.applications += stats.applications;
        all.converged = stats.converged;
        this->add_to_curve(all.iterations, all.applications, rms);
        if (all.converged || stats.residual.bad_contact >= 0) {
          all.residual = stats.residual;
          this->take_velocity(*solver);
          return all;
        }
        idle = least < 0 || rms < kProgress * least ? 0 : idle + 1;
        if (least < 0 || rms < least) {
          least = rms;
          all.residual = stats.residual;
          best.reserve_discard(gamma.size);
          copy(b, Span<const Vec3<Real>>(gamma), best.view(gamma.size));
        }
        solver->forget_velocity();
      }
    }
    copy(b, Span<const Vec3<Real>>(best.view(gamma.size)), gamma);
    return all;
  }

  /// @param first  what was done before on the same problem
  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance,
                 const SolveStats& first) {
    const Span<Twist<Real>> velocity = this->start_velocity(b, p);
    if (p.contacts_in_all() == 0) return {0, 0, true, {}};
    const Index contacts = p.own_contacts();
    Workspace w(b, contacts);
    const Span<Real> shift = w.shift.view(), change = w.change.view(), bias = w.bias.view();
    ContactProblem<Real> shifted = p;
    shifted.bias = ContactBias<Real>(bias);
    double relaxation = 1;
    // Moves the shift towards what the present velocities ask for; returns the RMS distance to it.
    const auto update_bias = [&](Span<const Vec3<Real>> guess) {
      // Both ranks of a contact across a border move its shift, and one counts it.
      reduce_contacts<ShiftSums>(b, p, ShiftChange<R, Real>{p, velocity, shift, change, guess},
                                 StoreResult<ShiftSums>{w.sums.data()});
      const ShiftSums sums = fetch(b, w.sums.data());
      relaxation = next_relaxation(relaxation, sums);
      for_each(b, contacts,
               ShiftBias<Real>{static_cast<Real>(relaxation), p.bias, change, shift, bias});
      return std::sqrt(sums.change_squares / p.contacts_in_all());
    };

    ContactPasses<R, B, Real>::project_impulses(b, p, gamma);
    ContactPasses<R, B, Real>::gather_velocities(b, p, gamma, velocity);
    this->update_ghosts(b, velocity);
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
    w.residual.template add_own<R>(b, p, gamma, velocity, stats.residual);
    return stats;
  }

  /// Residual of given impulses, and their velocities.
  template <class R>
  Residual result_of(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma) {
    const Span<Twist<Real>> velocity = this->start_velocity(b, p);
    ContactPasses<R, B, Real>::gather_velocities(b, p, gamma, velocity);
    this->update_ghosts(b, velocity);
    ResidualEvaluator<B, Real> evaluator(b);
    Residual residual = evaluator.template evaluate_with_objective<R>(b, p, gamma, velocity);
    evaluator.template add_own<R>(b, p, gamma, velocity, residual);
    return residual;
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
  /// A round of a direct solver helps when it leaves less than that of the least residual so far.
  static constexpr double kProgress = 0.9;
  static constexpr int kIdle = 5;  ///< rounds in a row that need not help

  std::unique_ptr<Solver<B, Real>> inner_;
  std::vector<std::unique_ptr<Solver<B, Real>>> direct_;
  int max_outer_iterations_;
};

/// What the solver of the exact problem holds beside that of the convex one: velocities, shift and
/// bias; after the solver's own steps also the best impulses, while more rounds follow.
inline HeldBytes exact_memory(const SolverCard& card, const SolverCase& c) {
  return {c.twist(), 3 * c.real + (card.steps_to_coulomb ? c.impulse() : 0)};
}

/// Solver of the exact problem by the name of one of the convex problem.
/// @param params  max_iterations is the most of APGD's own iterations and of each convex solve
/// @throws InvalidParameter
template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_exact_solver(const std::string& name, SolverParams params,
                                                   int max_outer_iterations) {
  auto inner = make_solver<B, Real>(name, params);
  std::vector<std::unique_ptr<Solver<B, Real>>> direct;
  if (solver_card(name).steps_to_coulomb) {
    for (const ApgdLaw law : {ApgdLaw::coulomb, ApgdLaw::lifted}) {
      params.law = law;
      direct.push_back(make_solver<B, Real>(name, params));
    }
  }
  return std::make_unique<CoulombFixedPoint<B, Real>>(std::move(inner), max_outer_iterations,
                                                      std::move(direct));
}

}  // namespace scree
