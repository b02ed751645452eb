#include "solvers/rolling/rolling_monitor.h"

#include <algorithm>
#include <cmath>

namespace scree {
namespace {

double root_of(const std::vector<double>& scales, std::size_t row) {
  return std::sqrt(scales[2 * (row / 5) + (row % 5 < 3 ? 0 : 1)]);
}

}  // namespace

RollingMonitor::RollingMonitor(const RollingProblem& problem, const std::vector<double>& scales,
                               const AssembledOptions& options,
                               std::vector<AssembledCurvePoint>* curve)
    : problem_(problem), scales_(scales), options_(options), account_(problem.q, options, curve) {}

bool RollingMonitor::over(const std::vector<double>& x) {
  looked_ = false;
  if (stopped_) return true;
  const int k = account_.iterations();
  if (k % check_every_ == 0 || k >= phase_end_ || out_of_time()) look(x);
  return stopped_ || k >= phase_end_;
}

void RollingMonitor::count(int products) {
  account_.set_iterations(account_.iterations() + 1);
  account_.count_applications(products);
}

bool RollingMonitor::next_phase(int most, int check_every) {
  const int left = options_.max_iterations - account_.iterations();
  if (stopped_) return false;
  check_every_ = options_.check_every > 0 ? options_.check_every : check_every;
  phase_end_ = account_.iterations() + std::min(most, left);
  return true;
}

void RollingMonitor::look(const std::vector<double>& x) {
  std::vector<double> r = x;
  for (std::size_t row = 0; row < r.size(); ++row) r[row] /= root_of(scales_, row);
  const std::vector<double> u = contact_velocity(problem_, r);
  account_.count_applications(1);
  looked_ = true;
  const AssembledResidual residual = measure(problem_, options_.model, scales_, r, u, &state_);
  if (!account_.take(r, u, residual, state_))
    return fail(AssembledStatus::diverged, "an iterate is not finite");
  if (options_.tolerance > 0 && value_of(residual, options_.measure) <= options_.tolerance) {
    fail(AssembledStatus::converged, {});
  } else if (account_.iterations() >= options_.max_iterations) {
    fail(AssembledStatus::iteration_limit, {});
  } else if (out_of_time()) {
    fail(AssembledStatus::time_limit, {});
  }
}

std::vector<double> RollingMonitor::scaled_impulses(std::vector<double> r) const {
  for (std::size_t row = 0; row < r.size(); ++row) r[row] *= root_of(scales_, row);
  return r;
}

void RollingMonitor::fail(AssembledStatus status, const std::string& text) {
  account_.set_status(status);
  stopped_ = true;
  note(text);
}

}  // namespace scree
