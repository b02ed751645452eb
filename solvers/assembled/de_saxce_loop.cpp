#include "solvers/assembled/de_saxce_loop.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/assembled/model_problem.h"

namespace scree {
namespace {

/// mu |u_t| of all contacts.
std::vector<double> lift_of(const AssembledProblem& p, const std::vector<double>& u) {
  std::vector<double> lift(p.contact_count);
  for (int c = 0; c < p.contact_count; ++c)
    lift[c] = p.mu[c] * std::hypot(u[3 * c + 1], u[3 * c + 2]);
  return lift;
}

/// Aitken's factor from the last two differences between new and old values.
double next_factor(double factor, const std::vector<double>& last, const std::vector<double>& now) {
  double above = 0, below = 0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double d = now[k] - last[k];
    above += last[k] * d;
    below += d * d;
  }
  if (!(below > 0)) return factor;
  return std::clamp(-factor * above / below, 0.05, 1.0);
}

}  // namespace

void run_de_saxce_loop(const AssembledSolver& convex, const AssembledProblem& problem,
                       const AssembledOptions& options, AssembledMonitor& monitor) {
  const bool unsymmetric = asymmetry(problem) > symmetric_to;
  AssembledProblem inner = unsymmetric ? symmetrized(problem) : problem;
  const AssembledTraits traits = convex.traits();
  std::vector<double> r = options.guess, full, symmetric;
  if (monitor.check(0, r)) return;
  std::vector<double> lift = lift_of(problem, monitor.last_velocity()), last_change;
  double factor = 1;
  for (int k = 1;; ++k) {
    inner.q = problem.q;
    for (int c = 0; c < problem.contact_count; ++c) inner.q[3 * c] += lift[c];
    if (unsymmetric) {
      multiply(problem, r, full);
      multiply(inner, r, symmetric);
      monitor.count_applications(2);
      for (std::size_t i = 0; i < full.size(); ++i) inner.q[i] += full[i] - symmetric[i];
    }
    AssembledOptions inner_options;
    inner_options.model = AssembledModel::convex;
    // Never below what the outer error is worth, and a little below the tolerance at the end.
    inner_options.tolerance = std::max(0.1 * monitor.last().relative, 0.1 * options.tolerance);
    inner_options.tolerance = std::min(inner_options.tolerance, 1e-2);
    inner_options.max_iterations = traits.default_iterations;
    inner_options.check_every = traits.default_check_every;
    if (options.max_seconds > 0)
      inner_options.max_seconds = std::max(1e-3, options.max_seconds - monitor.seconds());
    inner_options.relaxation = options.relaxation;
    inner_options.guess = r;
    AssembledMonitor inner_monitor(inner, inner_options, nullptr);
    convex.run(inner, inner_options, inner_monitor);
    const AssembledResult result = inner_monitor.finish();
    monitor.count_applications(result.applications);
    monitor.count_factorizations(result.factorizations);
    if (result.status == AssembledStatus::no_solution) {
      // Of the convex problem; the exact one may have one.
      if (!monitor.fail_if_unsolvable()) monitor.fail(AssembledStatus::diverged, result.note);
      return;
    }
    if (result.status == AssembledStatus::singular ||
        result.status == AssembledStatus::unsupported) {
      monitor.fail(result.status, result.note);
      return;
    }
    r = result.r;
    if (monitor.check(k, r)) return;
    const std::vector<double> wanted = lift_of(problem, monitor.last_velocity());
    std::vector<double> change(wanted.size());
    for (std::size_t c = 0; c < change.size(); ++c) change[c] = wanted[c] - lift[c];
    if (!last_change.empty()) factor = next_factor(factor, last_change, change);
    for (std::size_t c = 0; c < change.size(); ++c) lift[c] += factor * change[c];
    last_change = change;
  }
}

}  // namespace scree
