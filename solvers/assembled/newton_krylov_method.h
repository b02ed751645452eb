#pragma once
// Newton's method on contact functions with Krylov steps on a backend, for newton_krylov and
// hybrid_krylov.

#include <algorithm>

#include "solvers/assembled/krylov.h"

namespace scree {

struct NewtonKrylovSettings {
  /// Added to W in the Jacobian alone, in units of contact_scales: makes it regular where contacts
  /// are redundant. Steps are then no longer exactly Newton's.
  double shift = 0;
  int trials = 12;              ///< halvings of a step before giving up
  double least_descent = 1e-4;  ///< Armijo's constant
  int krylov_iterations = 200;  ///< most for one step
};

/// Function, derivatives and preconditioner of a contact at (r, W r + q), and D F^2.
struct EvaluateContact {
  static constexpr const char* name = "evaluate_contact";
  AssembledModel model;
  BlockRows w;
  Span<const double> q, mu, scale, shift;
  Span<const double> r, moved;
  Span<double> value;
  Span<Block3> by_r, by_u, inverse;

  SCREE_HD Sums<1> operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    const Block3& d = w.diagonal(c);
    const double u[3] = {moved[at] + q[at], moved[at + 1] + q[at + 1], moved[at + 2] + q[at + 2]};
    const ContactFunction f =
        contact_function(model, mu[c], contact_weights(d, scale[c]), scale[c], &r[at], u);
    by_r[c] = f.by_r;
    by_u[c] = f.by_u;
    Block3 own = f.by_r;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k)
          own[3 * i + j] += f.by_u[3 * i + k] * (d[3 * k + j] + (k == j ? shift[c] : 0));
    inverse[c] = inverse_block(own);
    Sums<1> sum;
    for (int i = 0; i < 3; ++i) {
      value[at + i] = f.value[i];
      sum.value[0] += scale[c] * f.value[i] * f.value[i];
    }
    return sum;
  }
};

/// trial = r - length step.
struct NewtonTrial {
  static constexpr const char* name = "newton_trial";
  Span<const double> r, step;
  double length;
  Span<double> trial;
  SCREE_HD void operator()(Index i) const { trial[i] = r[i] - length * step[i]; }
};

/// Runs from a guess until the monitor stops it, or fails it as `singular` or `stalled`. See
/// newton_krylov.inst.h for the method.
template <class B>
void run_newton_krylov(const BackendProblem<B>& p, AssembledModel model,
                       const std::vector<double>& guess, const NewtonKrylovSettings& settings,
                       AssembledMonitor& monitor) {
  B& b = p.backend();
  const Index n = p.contact_count();
  const Offset rows = p.row_count();
  std::vector<double> host_scale = contact_scales(p.host());
  Buffer<B, double> scale(b), shift(b), r = p.vector(guess), trial = p.vector(), moved = p.vector(),
                                        trial_moved = p.vector();
  Buffer<B, Block3> by_r(b, n), by_u(b, n), inverse(b, n);
  Buffer<B, Sums<1>> sum(b, 1);
  upload(b, host_scale, scale);
  for (double& s : host_scale) s *= settings.shift;
  upload(b, host_scale, shift);
  BlockKrylov<B> krylov(p);
  /// The merit 1/2 |D^1/2 F|^2 [J], with F in the right side of the next system.
  const auto evaluate = [&](const Buffer<B, double>& at, Buffer<B, double>& at_moved) {
    p.multiply(at, at_moved);
    monitor.count_applications();
    reduce<Sums<1>>(b, n,
                    EvaluateContact{model, p.rows(), p.q(), p.mu(), scale.view(n), shift.view(n),
                                    at.view(rows), std::as_const(at_moved).view(rows),
                                    krylov.right_side(), by_r.view(), by_u.view(), inverse.view()},
                    StoreResult<Sums<1>>{sum.data()});
    return 0.5 * fetch(b, sum.data()).value[0];
  };
  const ContactJacobian J{by_r.view(), by_u.view(), inverse.view(), shift.view(n)};
  double merit = evaluate(r, moved);
  double reduction = 1e-2;
  for (int k = 0;; ++k) {
    if (monitor.due(k) && p.look(monitor, k, r, moved)) return;
    const double reached = krylov.solve(J, reduction, settings.krylov_iterations, monitor);
    if (!(reached < 1))
      return monitor.fail(AssembledStatus::singular, "no solution of the linear system is found");
    double length = 1;
    for (int t = 0;; ++t, length *= 0.5) {
      for_each(b, p.row_count(),
               NewtonTrial{r.view(rows), krylov.solution(), length, trial.view(rows)});
      const double next = evaluate(trial, trial_moved);
      if (next <= (1 - 2 * settings.least_descent * length) * merit) {
        // Systems are solved as well as the last step was good (Eisenstat and Walker).
        reduction = std::clamp(0.9 * next / merit, 1e-8, 1e-2);
        merit = next;
        break;
      }
      if (t == settings.trials)
        return monitor.fail(AssembledStatus::stalled, "no descent of the merit function");
    }
    swap(r, trial);
    swap(moved, trial_moved);
  }
}

}  // namespace scree
