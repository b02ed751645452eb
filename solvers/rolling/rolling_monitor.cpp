#include "solvers/rolling/rolling_monitor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree {
namespace {

double norm_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

double root_of(const std::vector<double>& scales, std::size_t row) {
  return std::sqrt(scales[2 * (row / 5) + (row % 5 < 3 ? 0 : 1)]);
}

}  // namespace

RollingMonitor::RollingMonitor(const RollingProblem& problem, const std::vector<double>& scales,
                               const AssembledOptions& options,
                               std::vector<AssembledCurvePoint>* curve)
    : problem_(problem), scales_(scales), options_(options), curve_(curve) {
  result_.r.assign(problem.q.size(), 0.0);
}

bool RollingMonitor::over(const std::vector<double>& x) {
  looked_ = false;
  if (stopped_) return true;
  const int k = result_.iterations;
  if (k % check_every_ == 0 || k >= phase_end_ || out_of_time()) look(x);
  return stopped_ || k >= phase_end_;
}

void RollingMonitor::count(int products) {
  ++result_.iterations;
  result_.applications += products;
}

bool RollingMonitor::next_phase(int most, int check_every) {
  const int left = options_.max_iterations - result_.iterations;
  if (stopped_) return false;
  check_every_ = options_.check_every > 0 ? options_.check_every : check_every;
  phase_end_ = result_.iterations + std::min(most, left);
  return true;
}

void RollingMonitor::look(const std::vector<double>& x) {
  std::vector<double> r = x;
  for (std::size_t row = 0; row < r.size(); ++row) r[row] /= root_of(scales_, row);
  const std::vector<double> u = contact_velocity(problem_, r);
  ++result_.applications;
  looked_ = true;
  last_ = measure(problem_, options_.model, scales_, r, u, &state_);
  if (!std::isfinite(last_.absolute) || !std::isfinite(norm_of(r)))
    return fail(AssembledStatus::diverged, "an iterate is not finite");
  const double value = value_of(last_, options_.measure);
  if (!has_best_ || value < value_of(result_.residual, options_.measure)) {
    result_.r = r;
    result_.residual = last_;
    has_best_ = true;
  }
  if (curve_ != nullptr) record(u, r);
  last_state_ = state_;
  if (options_.tolerance > 0 && value <= options_.tolerance) {
    fail(AssembledStatus::converged, {});
  } else if (result_.iterations >= options_.max_iterations) {
    fail(AssembledStatus::iteration_limit, {});
  } else if (out_of_time()) {
    fail(AssembledStatus::time_limit, {});
  }
}

void RollingMonitor::record(const std::vector<double>& u, const std::vector<double>& r) {
  AssembledCurvePoint point;
  point.iteration = result_.iterations;
  point.applications = result_.applications;
  point.seconds = seconds();
  point.residual = last_;
  for (std::size_t c = 0; c < last_state_.size(); ++c)
    point.state_changes += state_[c] != last_state_[c];
  const std::vector<double>& known = options_.reference_velocity;
  if (!known.empty()) {
    const bool has_impulse = !options_.reference_impulse.empty();
    double square = 0, power = 0;
    for (std::size_t k = 0; k < u.size(); ++k) {
      const double d = u[k] - known[k];
      square += d * d;
      if (has_impulse) power += d * (r[k] - options_.reference_impulse[k]);
    }
    const double size = std::max(norm_of(known), 1e-3 * norm_of(problem_.q));
    point.velocity_error = size > 0 ? std::sqrt(square) / size : square;
    if (has_impulse) point.kinetic_error = std::max(0.0, 0.5 * power);
  }
  curve_->push_back(point);
}

std::vector<double> RollingMonitor::scaled_impulses(std::vector<double> r) const {
  for (std::size_t row = 0; row < r.size(); ++row) r[row] *= root_of(scales_, row);
  return r;
}

void RollingMonitor::fail(AssembledStatus status, const std::string& text) {
  result_.status = status;
  stopped_ = true;
  note(text);
}

void RollingMonitor::note(const std::string& text) {
  if (text.empty()) return;
  if (!result_.note.empty()) result_.note += "; ";
  result_.note += text;
}

double RollingMonitor::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

AssembledResult RollingMonitor::finish() {
  result_.seconds = seconds();
  return std::move(result_);
}

}  // namespace scree
