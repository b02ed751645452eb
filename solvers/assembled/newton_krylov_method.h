#pragma once
// Newton's method on contact functions with Krylov steps on a backend, for newton_krylov and for
// the solvers that build on it.

#include <algorithm>

#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/krylov.h"
#include "solvers/assembled/newton_endings.h"
#include "solvers/assembled/newton_system.h"

namespace scree {

struct NewtonKrylovSettings {
  /// Added to W in the Jacobian alone, in units of contact_scales: makes it regular where contacts
  /// are redundant. Steps are then no longer exactly Newton's.
  double shift = 0;
  int trials = 12;              ///< halvings of a step before giving up
  double least_descent = 1e-4;  ///< Armijo's constant
  int krylov_iterations = 200;  ///< most for one step
  /// Whether a stall tells a step that does not lead down from a trap, which takes a product on the
  /// host and the trials of a step.
  bool tells_traps = false;
  double tolerance = 0;  ///< of another law than the cone's, as in NewtonSettings
};

/// Function, derivatives and preconditioner of a contact at (r, W r + q), and D F^2.
/// @tparam Function  ConeFunction or MinMaxFunction
template <class Function>
struct EvaluateContact {
  static constexpr const char* name = "evaluate_contact";
  Function function;
  BlockRows w;
  Span<const double> q, mu, scale, shift;
  Span<const double> r, moved;
  Span<double> value;
  Span<Block3> by_r, by_u, inverse;

  SCREE_HD Sums<1> operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    const Block3& d = w.diagonal(c);
    const double u[3] = {moved[at] + q[at], moved[at + 1] + q[at + 1], moved[at + 2] + q[at + 2]};
    const ContactFunction f = function(mu[c], d, scale[c], &r[at], u);
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

/// One solve.
template <class B, class Function>
class NewtonKrylovRun {
 public:
  /// All must outlive this.
  NewtonKrylovRun(const BackendProblem<B>& p, Function function, const std::vector<double>& guess,
                  const NewtonKrylovSettings& settings, AssembledMonitor& monitor)
      : p_(p),
        function_(function),
        settings_(settings),
        monitor_(monitor),
        host_scale_(contact_scales(p.host())),
        scale_(p.backend()),
        shift_(p.backend()),
        r_(p.vector(guess)),
        trial_(p.vector()),
        moved_(p.vector()),
        trial_moved_(p.vector()),
        by_r_(p.backend(), p.contact_count()),
        by_u_(p.backend(), p.contact_count()),
        inverse_(p.backend(), p.contact_count()),
        sum_(p.backend(), 1),
        krylov_(p) {
    std::vector<double> shifts = host_scale_;
    for (double& s : shifts) s *= settings.shift;
    upload(p.backend(), host_scale_, scale_);
    upload(p.backend(), shifts, shift_);
    merit_ = evaluate(r_, moved_);
  }

  void run() {
    const double load = settings_.tolerance * scaled_load(p_.host(), host_scale_);
    const ContactJacobian J{by_r_.view(), by_u_.view(), inverse_.view(),
                            shift_.view(p_.contact_count())};
    double reduction = 1e-2;
    for (int k = 0;; ++k) {
      if (monitor_.due(k) && check(k)) return;
      if constexpr (Function::other_law != nullptr) {
        if (std::sqrt(2 * merit_) <= load) {
          if (!stops_at(k)) fail_as_solved(monitor_, Function::other_law);
          return;
        }
      }
      const double reached = krylov_.solve(J, reduction, settings_.krylov_iterations, monitor_);
      if (!(reached < 1)) {
        if (!stops_at(k))
          monitor_.fail(AssembledStatus::singular, "no solution of the linear system is found");
        return;
      }
      const double before = merit_;
      // Along a Newton step the merit falls by twice itself at first.
      if (!descend(krylov_.solution(), 2 * merit_)) {
        if (!stops_at(k)) stall();
        return;
      }
      // Systems are solved as well as the last step was good (Eisenstat and Walker).
      reduction = std::clamp(0.9 * merit_ / before, 1e-8, 1e-2);
    }
  }

 private:
  bool check(int k) { return p_.check(monitor_, k, r_, moved_); }
  /// Lets the monitor see the last iterate if it has not. @return whether it stops there itself
  bool stops_at(int k) { return !monitor_.due(k) && check(k); }

  /// The merit 1/2 |D^1/2 F|^2 [J], with F in the right side of the next system.
  double evaluate(const Buffer<B, double>& at, Buffer<B, double>& at_moved) {
    const Index n = p_.contact_count();
    p_.multiply(at, at_moved);
    monitor_.count_applications();
    reduce<Sums<1>>(p_.backend(), n,
                    EvaluateContact<Function>{
                        function_, p_.rows(), p_.q(), p_.mu(), std::as_const(scale_).view(n),
                        std::as_const(shift_).view(n), at.view(p_.row_count()),
                        std::as_const(at_moved).view(p_.row_count()), krylov_.right_side(),
                        by_r_.view(), by_u_.view(), inverse_.view()},
                    StoreResult<Sums<1>>{sum_.data()});
    return 0.5 * fetch(p_.backend(), sum_.data()).value[0];
  }

  /// Backtracks from r - step until the merit is less by Armijo's share of its slope.
  /// @return whether it found such a point; r is then that one, and as it was otherwise
  bool descend(Span<const double> step, double slope) {
    const Index rows = p_.row_count();
    double length = 1;
    for (int t = 0; t <= settings_.trials; ++t, length *= 0.5) {
      for_each(p_.backend(), rows, NewtonTrial{r_.view(rows), step, length, trial_.view(rows)});
      const double next = evaluate(trial_, trial_moved_);
      if (!(next <= merit_ - settings_.least_descent * length * slope)) continue;
      merit_ = next;
      swap(r_, trial_);
      swap(moved_, trial_moved_);
      return true;
    }
    return false;
  }

  void stall() {
    if (!settings_.tells_traps)
      return monitor_.fail(AssembledStatus::stalled, "no descent of the merit function");
    std::vector<double> slope = gradient();
    const double steepest = dot(slope, slope);
    for (double& x : slope) x *= merit_ / steepest;
    const Buffer<B, double> step = p_.vector(slope);
    fail_as_stalled(monitor_, !descend(step.view(p_.row_count()), merit_));
  }

  /// Of the merit at r, computed on the host: backends have no transposed product.
  std::vector<double> gradient() {
    B& b = p_.backend();
    evaluate(r_, moved_);
    const std::vector<double> value = download(b, krylov_.right_side());
    const std::vector<Block3> by_r = download(b, by_r_.view()), by_u = download(b, by_u_.view());
    std::vector<ContactFunction> at(by_r.size());
    for (std::size_t c = 0; c < at.size(); ++c)
      at[c] = {{value[3 * c], value[3 * c + 1], value[3 * c + 2]}, by_r[c], by_u[c]};
    return merit_gradient(p_.host(), host_scale_, settings_.shift, at);
  }

  const BackendProblem<B>& p_;
  Function function_;
  const NewtonKrylovSettings& settings_;
  AssembledMonitor& monitor_;
  std::vector<double> host_scale_;
  Buffer<B, double> scale_, shift_, r_, trial_, moved_, trial_moved_;
  Buffer<B, Block3> by_r_, by_u_, inverse_;
  Buffer<B, Sums<1>> sum_;
  BlockKrylov<B> krylov_;
  double merit_ = 0;
};

/// Runs from a guess until the monitor stops it, or fails it as `singular` or `stalled`: the latter
/// also where another law is solved, as run_newton() does. See newton_krylov.inst.h for the method.
template <class B, class Function>
void run_newton_krylov(const BackendProblem<B>& p, Function function,
                       const std::vector<double>& guess, const NewtonKrylovSettings& settings,
                       AssembledMonitor& monitor) {
  NewtonKrylovRun<B, Function>(p, function, guess, settings, monitor).run();
}

}  // namespace scree
