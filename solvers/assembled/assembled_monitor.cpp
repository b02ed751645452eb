#include "solvers/assembled/assembled_monitor.h"

#include <algorithm>
#include <utility>

#include "solvers/assembled/infeasibility.h"

namespace scree {

AssembledMonitor::AssembledMonitor(const AssembledProblem& problem, const AssembledOptions& options,
                                   std::vector<AssembledCurvePoint>* curve)
    : problem_(problem),
      options_(options),
      account_(problem.q, options, curve),
      scale_(contact_scales(problem)),
      phase_limit_(options.max_iterations),
      check_every_(std::max(1, options.check_every)) {}

bool AssembledMonitor::due(int iteration) const {
  return iteration % check_every_ == 0 || iteration >= phase_limit_ || out_of_time();
}

int AssembledMonitor::until_due(int iteration) const {
  const int to_check = check_every_ - iteration % check_every_;
  return std::max(1, std::min(to_check, phase_limit_ - iteration));
}

bool AssembledMonitor::check(int iteration, const std::vector<double>& r) {
  count_applications();
  return check(iteration, r, contact_velocity(problem_, r));
}

bool AssembledMonitor::check(int iteration, const std::vector<double>& r,
                             const std::vector<double>& u) {
  if (stopped_) return true;
  last_r_ = r;
  velocity_ = u;
  account_.set_iterations(phase_start_ + iteration);
  const AssembledResidual residual = measure(problem_, options_.model, scale_, r, u, &state_);
  if (!account_.take(r, u, residual, state_)) {
    fail(AssembledStatus::diverged, "an iterate is not finite");
    return true;
  }
  if (reached(residual)) {
    fail(AssembledStatus::converged);
  } else if (!asked_ && options_.tell_unsolvable && grows(r, u) && fail_if_unsolvable()) {
    return true;
  } else if (iteration >= phase_limit_) {
    fail(AssembledStatus::iteration_limit);
  } else if (out_of_time()) {
    fail(AssembledStatus::time_limit);
  }
  return stopped_;
}

bool AssembledMonitor::reached(const AssembledResidual& residual) const {
  const double goal = options_.goal > 0 ? options_.goal : options_.tolerance;
  return goal > 0 && value_of(residual, options_.measure) <= goal;
}

bool AssembledMonitor::grows(const std::vector<double>& r, const std::vector<double>& u) const {
  std::vector<double> moved = u;
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k] -= problem_.q[k];
  return grows_without_bound(problem_, r, moved);
}

bool AssembledMonitor::fail_if_unsolvable() {
  if (!asked_) {
    asked_ = true;
    const double left = options_.max_seconds - seconds();
    unsolvable_ = has_no_solution(problem_, options_.model,
                                  options_.max_seconds > 0 ? std::max(1e-3, left) : 0);
  }
  if (unsolvable_)
    fail(AssembledStatus::no_solution,
         options_.model == AssembledModel::convex
             ? "impulses grow without bound in a direction that W does not resist"
             : "some contacts approach whatever the impulses");
  return unsolvable_;
}

void AssembledMonitor::fail(AssembledStatus status, std::string text) {
  account_.set_status(status);
  stopped_ = true;
  failure_ = std::move(text);
}

bool AssembledMonitor::next_phase(int most, int check_every) {
  const int left = options_.max_iterations - account_.iterations();
  if (converged() || out_of_time() || left <= 0) return false;
  if (status() == AssembledStatus::no_solution) return false;
  phase_start_ = account_.iterations();
  phase_limit_ = most > 0 ? std::min(most, left) : left;
  check_every_ = std::max(1, check_every > 0 ? check_every : options_.check_every);
  stopped_ = false;
  failure_.clear();
  account_.set_status(AssembledStatus::iteration_limit);
  return true;
}

AssembledResult AssembledMonitor::finish() {
  note(failure_);
  return account_.finish();
}

}  // namespace scree
