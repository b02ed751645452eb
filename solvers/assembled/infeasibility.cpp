#include "solvers/assembled/infeasibility.h"

#include <algorithm>
#include <cmath>

#include "solvers/assembled/assembled_solver.h"

namespace scree {

int untouchable_contact(const AssembledProblem& p) {
  for (int c = 0; c < p.contact_count; ++c) {
    if (!(p.q[3 * c] < 0)) continue;
    bool zero = true;
    for (int k = p.row_start[c]; zero && k < p.row_start[c + 1]; ++k)
      zero = std::all_of(p.block[k].begin(), p.block[k].end(),
                         [](double x) { return !(std::abs(x) > 0); });
    if (zero) return c;
  }
  return -1;
}

bool grows_without_bound(const AssembledProblem& p, const std::vector<double>& r) {
  std::vector<double> moved;
  if (r.size() != p.q.size()) return false;
  multiply(p, r, moved);
  return grows_without_bound(p, r, moved);
}

bool grows_without_bound(const AssembledProblem& p, const std::vector<double>& r,
                         const std::vector<double>& moved) {
  const std::vector<double> scale = contact_scales(p);
  double along = 0, resistance = 0, loads = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    along += p.q[i] * r[i];
    resistance += moved[i] * moved[i] / scale[i / 3];
    loads += p.q[i] * p.q[i] / scale[i / 3];
  }
  // |q.d| / |W d| in the metric of the scales, against |q| / D.
  return along < 0 && -along > 1e3 * std::sqrt(resistance * loads);
}

namespace {

/// The end of the impulses of the interior point method where the convex problem has no solution;
/// empty where it has one, or time does not suffice.
std::vector<double> unbounded_impulses(const AssembledProblem& p, double max_seconds) {
  AssembledOptions o;
  o.model = AssembledModel::convex;
  o.tolerance = 1e-6;
  o.max_seconds = max_seconds;
  o.tell_unsolvable = false;
  const auto solver = make_assembled_solver("interior_point");
  o.max_iterations = solver->traits().default_iterations;
  o.check_every = 1;
  o.guess.assign(p.q.size(), 0.0);
  AssembledMonitor monitor(p, o, nullptr);
  solver->run(p, o, monitor);
  std::vector<double> last = monitor.last_impulses();
  if (monitor.finish().status != AssembledStatus::no_solution) last.clear();
  return last;
}

}  // namespace

bool has_no_solution(const AssembledProblem& p, AssembledModel model, double max_seconds) {
  if (model == AssembledModel::convex) return !unbounded_impulses(p, max_seconds).empty();
  AssembledProblem frictionless = symmetrized(p);
  std::fill(frictionless.mu.begin(), frictionless.mu.end(), 0.0);
  std::vector<double> d = unbounded_impulses(frictionless, max_seconds);
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = i % 3 == 0 ? std::max(0.0, d[i]) : 0.0;
  return !d.empty() && grows_without_bound(p, d, multiply_transposed(p, d));
}

}  // namespace scree
