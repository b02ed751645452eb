#include "solvers/assembled/proximal_method.h"

#include <algorithm>
#include <limits>

#include "solvers/assembled/cone_vectors.h"
#include "solvers/assembled/newton_method.h"
#include "solvers/assembled/sweep.h"

namespace scree {
namespace {

/// Problem p with weight a around r: W + a D, q - a D r.
void regularize(const AssembledProblem& p, const std::vector<double>& scale, double a,
                const std::vector<double>& r, AssembledProblem& inner) {
  for (int c = 0; c < p.contact_count; ++c) {
    const Block3& from = p.diagonal(c);
    Block3& to = inner.diagonal(c);
    const double add = a * scale[c];
    for (int k = 0; k < 3; ++k) {
      to[4 * k] = from[4 * k] + add;
      inner.q[3 * c + k] = p.q[3 * c + k] - add * r[3 * c + k];
    }
  }
}

/// Whether residuals still fall by halves.
class Progress {
 public:
  /// @param patience  outer iterations that a half may take; 0: any number
  explicit Progress(int patience) : patience_(patience) {}

  /// @param residual  the one of outer iteration k
  /// @return          whether patience is at its end
  bool ended(int k, double residual) {
    if (residual <= 0.5 * least_) {
      least_ = residual;
      since_ = k;
    }
    return patience_ > 0 && k - since_ >= patience_;
  }

 private:
  int patience_;
  int since_ = 0;
  double least_ = std::numeric_limits<double>::infinity();
};

/// Adds the work of an inner solve.
void take_account(AssembledMonitor& outer, const AssembledResult& inner) {
  outer.count_applications(inner.applications);
  outer.count_factorizations(inner.factorizations);
}

}  // namespace

ProximalMethods host_proximal_methods() {
  ProximalMethods methods;
  methods.newton = [](const AssembledProblem& p, const AssembledOptions& o,
                      AssembledMonitor& monitor) { run_newton(p, o, {}, monitor); };
  methods.sweeps = [](const AssembledProblem& p, const AssembledOptions& o,
                      AssembledMonitor& monitor) {
    std::vector<double> x = o.guess;
    for (int i = 0; !monitor.look_if_due(i, x); ++i) {
      sweep(p, o.model, x);
      monitor.count_applications();
    }
  };
  return methods;
}

bool run_proximal(const AssembledProblem& p, const AssembledOptions& o,
                  const ProximalSettings& settings, AssembledMonitor& monitor,
                  const ProximalMethods& methods) {
  const std::vector<double> scale = contact_scales(p);
  AssembledProblem inner = p;
  std::vector<double> r = o.guess;
  double weight = settings.first_weight;
  bool failed = false;
  int opening_failures = 0;
  bool ever_solved = false;
  double growth = 2;
  Progress progress(settings.patience);
  for (int k = 0; !monitor.check(k, r); ++k) {
    if (progress.ended(k, monitor.last().relative)) {
      monitor.fail(AssembledStatus::stalled, "the proximal method no longer gains");
      break;
    }
    regularize(p, scale, weight, r, inner);
    AssembledOptions inner_options = o;
    inner_options.measure = AssembledMeasure::relative;
    inner_options.goal = 0;
    inner_options.reference_velocity.clear();
    // The absolute error asked for is a share of the present one.
    const double wanted = std::max(0.1 * monitor.last().absolute, 0.2 * o.tolerance * norm(p.q));
    inner_options.tolerance = wanted / std::max(norm(inner.q), 1e-300);
    if (o.max_seconds > 0)
      inner_options.max_seconds = std::max(1e-3, o.max_seconds - monitor.seconds());
    inner_options.guess = r;
    inner_options.tell_unsolvable = false;  // regular problems are solvable
    AssembledResult best;
    bool solved = false, quick = false;  // by the method that goes first
    if (settings.newton) {
      inner_options.max_iterations = settings.newton_iterations;
      inner_options.check_every = 1;
      AssembledMonitor inner_monitor(inner, inner_options, nullptr);
      methods.newton(inner, inner_options, inner_monitor);
      best = inner_monitor.finish();
      take_account(monitor, best);
      solved = best.status == AssembledStatus::converged;
      quick = solved && best.iterations <= settings.newton_iterations / 3;
    }
    if (!solved) {
      inner_options.max_iterations = settings.sweeps;
      inner_options.check_every = 10;
      AssembledMonitor inner_monitor(inner, inner_options, nullptr);
      methods.sweeps(inner, inner_options, inner_monitor);
      const AssembledResult swept = inner_monitor.finish();
      take_account(monitor, swept);
      if (!settings.newton) {
        solved = swept.status == AssembledStatus::converged;
        quick = solved && swept.iterations <= settings.sweeps / 3;
      }
      if (!settings.newton || swept.residual.relative < best.residual.relative) best = swept;
    }
    r = best.r;
    ever_solved = ever_solved || solved;
    if (!ever_solved && ++opening_failures == settings.most_opening_failures) {
      monitor.fail(AssembledStatus::stalled, "the proximal method fails from here");
      return false;
    }
    if (!settings.adapts) continue;
    // Boldly down until the method fails for the first time, carefully after that: a weight that is
    // too small for Newton throws away what several good steps have won.
    failed = failed || !solved;
    if (quick) weight = std::max(settings.least_weight, (failed ? 0.7 : 0.2) * weight);
    if (!solved) weight = std::min(settings.largest_weight, growth * weight);
    growth = solved ? 2 : std::min(settings.largest_growth, 2 * growth);
  }
  return true;
}

}  // namespace scree
