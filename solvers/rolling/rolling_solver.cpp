#include "solvers/rolling/rolling_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/joined.h"
#include "solvers/assembled/infeasibility.h"
#include "solvers/assembled/model_problem.h"
#include "solvers/assembled/solve_checks.h"
#include "solvers/rolling/rolling_methods.h"

namespace scree {
namespace {

constexpr int default_iterations = 100000;
constexpr int sweeps_a_look = 10;
/// Of the turns of auto: iterations of the first one; of those from which on, and contacts up to
/// which, proximal points are tried; how many.
constexpr int least_turn = 100, most_first_turn = 4000;
constexpr int long_turn = 3000, few_contacts = 300, proximal_turn = 40;

void check(const RollingProblem& p, const AssembledOptions& o) {
  const auto contacts = static_cast<std::size_t>(std::max(0, p.contact_count));
  check_rows_and_options({.contact_count = p.contact_count,
                          .contact_rows = 5,
                          .q = p.q,
                          .coefficients = {{"mu", &p.mu}, {"mu_r", &p.mu_r}},
                          .matrix_rows = 5 * contacts,
                          .row_start = p.row_start,
                          .column = p.column,
                          .entry_count = p.value.size()},
                         o);
}

/// A contact that approaches and whose normal row of W is zero; -1 when there is none.
int untouchable_contact(const RollingProblem& p) {
  for (int c = 0; c < p.contact_count; ++c) {
    const auto begin = p.value.begin() + p.row_start[5 * c];
    const auto end = p.value.begin() + p.row_start[5 * c + 1];
    if (p.q[5 * c] < 0 && std::none_of(begin, end, [](double w) { return std::abs(w) > 0; }))
      return c;
  }
  return -1;
}

/// Sweeps and accelerated steps by turns, each from where it was and twice as long as in the turn
/// before: what one of them solves takes a few times its time. Where both crawl, proximal points
/// from the best of them, if factors are cheap.
void run_auto(const RollingProblem& p, AssembledModel model, std::vector<double> swept,
              RollingMonitor& monitor) {
  std::vector<double> accelerated = swept;
  for (int turn = std::clamp(p.contact_count, least_turn, most_first_turn);
       monitor.next_phase(turn, sweeps_a_look);
       turn = 2 * std::min(turn, std::numeric_limits<int>::max() / 2)) {
    // For the convex model the latter are sure to arrive.
    if (model == AssembledModel::exact) run_rolling_sweeps(p, model, swept, monitor);
    if (!monitor.next_phase(turn, sweeps_a_look)) return;
    run_rolling_apgd(p, model, accelerated, monitor);
    if (turn < long_turn || p.contact_count > few_contacts) continue;
    if (!monitor.next_phase(proximal_turn, 1)) return;
    std::vector<double> x = monitor.best();
    run_rolling_proximal(p, model, x, monitor);
  }
}

}  // namespace

std::vector<std::string> rolling_solver_names() { return {"auto", "nlgs", "apgd", "proximal"}; }

AssembledResult solve_rolling(const std::string& name, const RollingProblem& problem,
                              const AssembledOptions& options,
                              std::vector<AssembledCurvePoint>* curve) {
  const std::vector<std::string> known = rolling_solver_names();
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw AssembledError(
        "solver \"" + name +
        "\" does not solve problems with rolling friction; those that do: " + joined(known));
  check(problem, options);
  AssembledOptions o = options;
  if (o.max_iterations == 0) o.max_iterations = default_iterations;
  const ModelProblem<RollingProblem> solved(problem, o.model);
  const RollingProblem& p = solved.get();
  const std::vector<double> scales = contact_scales(p);
  const RollingProblem free = scaled(p, scales);
  RollingMonitor monitor(p, scales, o, curve);
  monitor.note(solved.note());
  std::vector<double> x = monitor.scaled_impulses(
      o.guess.empty() ? std::vector<double>(problem.q.size(), 0.0) : o.guess);
  if (const int hopeless = untouchable_contact(p); hopeless >= 0) {
    monitor.over(x);
    monitor.fail(AssembledStatus::no_solution, untouchable_note(hopeless));
  } else if (name == "auto") {
    run_auto(free, o.model, x, monitor);
  } else if (name == "proximal") {
    monitor.next_phase(o.max_iterations, 1);
    run_rolling_proximal(free, o.model, x, monitor);
    if (!monitor.stopped())
      monitor.fail(AssembledStatus::stalled, "Newton's method fails at the largest weight");
  } else {
    monitor.next_phase(o.max_iterations, sweeps_a_look);
    (name == "nlgs" ? run_rolling_sweeps : run_rolling_apgd)(free, o.model, x, monitor);
  }
  return monitor.finish();
}

}  // namespace scree
