#include "solvers/assembled/assembled_monitor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/assembled/infeasibility.h"

namespace scree {
namespace {

double norm_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

const char* to_string(AssembledStatus status) {
  switch (status) {
    case AssembledStatus::converged:
      return "converged";
    case AssembledStatus::iteration_limit:
      return "iteration limit";
    case AssembledStatus::time_limit:
      return "time limit";
    case AssembledStatus::stalled:
      return "stalled";
    case AssembledStatus::diverged:
      return "diverged";
    case AssembledStatus::singular:
      return "singular";
    case AssembledStatus::no_solution:
      return "no solution";
    case AssembledStatus::unsupported:
      break;
  }
  return "unsupported";
}

AssembledMonitor::AssembledMonitor(const AssembledProblem& problem, const AssembledOptions& options,
                                   std::vector<AssembledCurvePoint>* curve)
    : problem_(problem),
      options_(options),
      curve_(curve),
      start_(std::chrono::steady_clock::now()),
      scale_(contact_scales(problem)),
      phase_limit_(options.max_iterations),
      check_every_(std::max(1, options.check_every)) {
  if (!options.reference_velocity.empty())
    reference_norm_ = std::max(norm_of(options.reference_velocity), 1e-3 * norm_of(problem.q));
  result_.r.assign(3 * static_cast<std::size_t>(problem.contact_count), 0.0);
}

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
  last_ = measure(problem_, options_.model, scale_, r, u, &state_);
  last_r_ = r;
  velocity_ = u;
  result_.iterations = phase_start_ + iteration;
  const double size = norm_of(r);
  if (!std::isfinite(last_.absolute) || !std::isfinite(size)) {
    fail(AssembledStatus::diverged, "an iterate is not finite");
    return true;
  }
  state_changes_ = 0;
  for (std::size_t c = 0; c < last_state_.size(); ++c)
    state_changes_ += state_[c] != last_state_[c];
  last_state_ = state_;
  if (!looked_ || keep_last_ ||
      value_of(last_, options_.measure) < value_of(result_.residual, options_.measure)) {
    result_.r = r;
    result_.residual = last_;
  }
  looked_ = true;
  if (curve_ != nullptr) {
    AssembledCurvePoint point;
    point.iteration = result_.iterations;
    point.applications = result_.applications;
    point.seconds = seconds();
    point.residual = last_;
    point.state_changes = state_changes_;
    compare(r, u, point);
    curve_->push_back(point);
  }
  if (reached(last_)) {
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

void AssembledMonitor::compare(const std::vector<double>& r, const std::vector<double>& u,
                               AssembledCurvePoint& point) const {
  if (options_.reference_velocity.empty()) return;
  const bool has_impulse = !options_.reference_impulse.empty();
  double square = 0, power = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double d = u[k] - options_.reference_velocity[k];
    square += d * d;
    if (has_impulse) power += d * (r[k] - options_.reference_impulse[k]);
  }
  point.velocity_error = reference_norm_ > 0 ? std::sqrt(square) / reference_norm_ : square;
  if (has_impulse) point.kinetic_error = std::max(0.0, 0.5 * power);
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
  result_.status = status;
  stopped_ = true;
  failure_ = std::move(text);
}

void AssembledMonitor::note(const std::string& text) {
  if (text.empty()) return;
  if (!result_.note.empty()) result_.note += "; ";
  result_.note += text;
}

bool AssembledMonitor::next_phase(int most, int check_every) {
  const int left = options_.max_iterations - result_.iterations;
  if (converged() || out_of_time() || left <= 0) return false;
  if (result_.status == AssembledStatus::no_solution) return false;
  phase_start_ = result_.iterations;
  phase_limit_ = most > 0 ? std::min(most, left) : left;
  check_every_ = std::max(1, check_every > 0 ? check_every : options_.check_every);
  stopped_ = false;
  failure_.clear();
  result_.status = AssembledStatus::iteration_limit;
  return true;
}

bool AssembledMonitor::out_of_time() const {
  return options_.max_seconds > 0 && seconds() >= options_.max_seconds;
}

double AssembledMonitor::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

AssembledResult AssembledMonitor::finish() {
  note(failure_);
  result_.seconds = seconds();
  return std::move(result_);
}

}  // namespace scree
