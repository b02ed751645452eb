#include "solvers/assembled/solve_account.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/assembled/cone_vectors.h"

namespace scree {

SolveAccount::SolveAccount(const std::vector<double>& q, const AssembledOptions& options,
                           std::vector<AssembledCurvePoint>* curve)
    : options_(options), curve_(curve) {
  if (!options.reference_velocity.empty())
    reference_norm_ = std::max(norm(options.reference_velocity), 1e-3 * norm(q));
  result_.r.assign(q.size(), 0.0);
}

bool SolveAccount::take(const std::vector<double>& r, const std::vector<double>& u,
                        const AssembledResidual& residual, const std::vector<ContactState>& state) {
  last_ = residual;
  if (!std::isfinite(residual.absolute) || !std::isfinite(norm(r))) return false;
  state_changes_ = 0;
  for (std::size_t c = 0; c < last_state_.size(); ++c) state_changes_ += state[c] != last_state_[c];
  last_state_ = state;
  if (!has_best_ || keep_last_ ||
      value_of(residual, options_.measure) < value_of(result_.residual, options_.measure)) {
    result_.r = r;
    result_.residual = residual;
    has_best_ = true;
  }
  if (curve_ != nullptr) {
    AssembledCurvePoint point;
    point.iteration = result_.iterations;
    point.applications = result_.applications;
    point.seconds = seconds();
    point.residual = residual;
    point.state_changes = state_changes_;
    compare(r, u, point);
    curve_->push_back(point);
  }
  return true;
}

void SolveAccount::compare(const std::vector<double>& r, const std::vector<double>& u,
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

void SolveAccount::note(const std::string& text) {
  if (text.empty()) return;
  if (!result_.note.empty()) result_.note += "; ";
  result_.note += text;
}

double SolveAccount::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

AssembledResult SolveAccount::finish() {
  result_.seconds = seconds();
  return std::move(result_);
}

}  // namespace scree
