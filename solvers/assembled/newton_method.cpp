#include "solvers/assembled/newton_method.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/newton_endings.h"
#include "solvers/assembled/newton_system.h"

namespace scree {
namespace {

/// Step over value of the function, both impulses, from which a step that leads nowhere down is
/// rounding of a singular Jacobian.
constexpr double singular_from = 1e5;

/// The function of all contacts at one point.
class Equations {
 public:
  /// All must outlive this.
  Equations(const AssembledProblem& p, AssembledModel model, const NewtonLaw& law)
      : p_(p), model_(model), law_(law), scale_(contact_scales(p)), at_(p.contact_count) {
    for (int c = 0; c < p.contact_count; ++c)
      weights_.push_back(contact_weights(p.diagonal(c), scale_[c]));
  }

  /// @return the merit 1/2 |D^1/2 F|^2 [J]
  double evaluate(const std::vector<double>& r, AssembledMonitor& monitor) {
    multiply(p_, r, u_);
    monitor.count_applications();
    double sum = 0;
    for (int c = 0; c < p_.contact_count; ++c) {
      for (int k = 0; k < 3; ++k) u_[3 * c + k] += p_.q[3 * c + k];
      at_[c] = law_.name.empty() ? contact_function(model_, p_.mu[c], weights_[c], scale_[c],
                                                    &r[3 * c], &u_[3 * c])
                                 : law_.function(c, &r[3 * c], &u_[3 * c]);
      for (const double f : at_[c].value) sum += scale_[c] * f * f;
    }
    return 0.5 * sum;
  }

  const std::vector<double>& velocity() const { return u_; }

  const std::vector<double>& scale() const { return scale_; }
  const std::vector<ContactFunction>& functions() const { return at_; }

  std::vector<double> value() const {
    std::vector<double> f;
    for (const ContactFunction& c : at_) f.insert(f.end(), c.value, c.value + 3);
    return f;
  }

 private:
  const AssembledProblem& p_;
  AssembledModel model_;
  const NewtonLaw& law_;
  std::vector<double> scale_;
  std::vector<ContactWeights> weights_;
  std::vector<ContactFunction> at_;
  std::vector<double> u_;
};

/// One solve.
class NewtonRun {
 public:
  NewtonRun(const AssembledProblem& p, const AssembledOptions& o, const NewtonSettings& settings,
            AssembledMonitor& monitor)
      : settings_(settings),
        monitor_(monitor),
        equations_(p, o.model, settings_.law),
        r_(o.guess),
        merit_(equations_.evaluate(r_, monitor)),
        settled_(o.tolerance * scaled_load(p, equations_.scale())),
        system_(p, equations_.scale(), settings.shift) {}

  void run() {
    for (int k = 0;; ++k) {
      if (monitor_.due(k) && monitor_.check(k, r_, equations_.velocity())) return;
      if (!settings_.law.name.empty() && std::sqrt(2 * merit_) <= settled_) {
        if (!monitor_.check(k, r_, equations_.velocity()))
          fail_as_solved(monitor_, settings_.law.name);
        return;
      }
      monitor_.count_factorizations();
      if (!system_.factorize(equations_.functions()))
        return monitor_.fail(AssembledStatus::singular, "the Jacobian is singular");
      const std::vector<double> value = equations_.value();
      long products = 0;
      const std::vector<double> step = system_.solve(value, products);
      monitor_.count_applications(products);
      if (!std::all_of(step.begin(), step.end(), [](double x) { return std::isfinite(x); }))
        return monitor_.fail(AssembledStatus::singular, "the Jacobian is singular to rounding");
      // Along a Newton step the merit falls by twice itself at first.
      if (descend(step, 2 * merit_)) continue;
      monitor_.check(k, r_);
      if (monitor_.stopped()) return;
      if (norm(step) > singular_from * norm(value))
        return monitor_.fail(AssembledStatus::singular, "the Jacobian is singular to rounding");
      std::vector<double> slope = system_.gradient();
      const double steepest = dot(slope, slope);
      for (double& x : slope) x *= merit_ / steepest;
      return fail_as_stalled(monitor_, !descend(slope, merit_));
    }
  }

 private:
  /// Backtracks from r - step until the merit is less by Armijo's share of its slope.
  /// @return whether it found such a point; r is then that one, and as it was otherwise
  bool descend(const std::vector<double>& step, double slope) {
    std::vector<double> trial(r_.size());
    double length = 1;
    for (int t = 0; t <= settings_.trials; ++t, length *= 0.5) {
      for (std::size_t i = 0; i < r_.size(); ++i) trial[i] = r_[i] - length * step[i];
      const double next = equations_.evaluate(trial, monitor_);
      if (!(next <= merit_ - settings_.least_descent * length * slope)) continue;
      merit_ = next;
      r_.swap(trial);
      return true;
    }
    return false;
  }

  const NewtonSettings& settings_;
  AssembledMonitor& monitor_;
  Equations equations_;
  std::vector<double> r_;
  double merit_;
  double settled_;
  NewtonSystem system_;
};

}  // namespace

void run_newton(const AssembledProblem& p, const AssembledOptions& o,
                const NewtonSettings& settings, AssembledMonitor& monitor) {
  NewtonRun(p, o, settings, monitor).run();
}

}  // namespace scree
