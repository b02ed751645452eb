#pragma once
// The arrays of a running APGD solve outside the solver, set up as Apgd::solve does it.

#include <string>
#include <vector>

#include "bench/bed_problem.h"
#include "kernels/solve/apgd_iteration.h"
#include "solvers/apgd.h"
#include "solvers/solver.h"

namespace scree::bench {

template <class B, class Real>
class ApgdArrays {
 public:
  using R = RadialRows<Real>;

  /// State before the first iteration, from random impulses.
  ApgdArrays(B& b, const BedProblem<B, Real>& bed, ApgdMetricKind kind)
      : problem_(bed.problem()), metric_(b), state_(b, 1), iteration_(b) {
    const ContactProblem<Real>& p = problem_;
    for (int k = 0; k < 2; ++k) {
      impulses_.emplace_back(b, p.contact_count);
      gamma.buffer[k] = impulses_.back().view(p.contact_count);
    }
    for (Span<Twist<Real>>* view :
         {&velocity.of_iterate[0], &velocity.of_iterate[1], &velocity.of_extrapolated}) {
      twists_.emplace_back(b, p.bodies.count);
      *view = twists_.back().view(p.bodies.count);
      for_each(b, p.bodies.count, StartVelocity<Real>{p, *view});
    }
    bed.random_impulses(b, 51, gamma.buffer[0]);
    for_each(b, p.contact_count, ProjectImpulses<R, Real>{p, gamma.buffer[0]});
    copy(b, Span<const Vec3<Real>>(gamma.buffer[0]), gamma.buffer[1]);
    for_each(b, p.bodies.owned_count,
             BodyVelocity<R, Real>{p, gamma.buffer[0], velocity.of_iterate[0]});
    if (kind == ApgdMetricKind::diagonal) {
      const Offset values =
          static_cast<Offset>(p.contact_count) * StoredMetric<R, Real>::per_contact(p);
      metric_.reserve_discard(values);
      metric = StoredMetric<R, Real>::on(p, metric_.view(values));
    }
    reduce<Largest<double>>(b, p.contact_count, ApgdMetric<R, Real>{p, metric},
                            ApgdStart{state_.data(), 0});
    iteration_.start(b, passes());
  }

  /// Unrelated random numbers in all arrays a pass reads, and a momentum as in
  /// the middle of a solve.
  void scramble(B& b, const BedProblem<B, Real>& bed) {
    for (unsigned k = 0; k < 2; ++k) {
      bed.random_impulses(b, 20 + k, gamma.buffer[k]);
      for_each(b, problem_.contact_count, ProjectImpulses<R, Real>{problem_, gamma.buffer[k]});
    }
    for (unsigned k = 0; k < 2; ++k) bed.random_velocities(b, 30 + k, velocity.of_iterate[k]);
    bed.random_velocities(b, 40, velocity.of_extrapolated);
    ApgdState middle = fetch(b, state_.data());
    middle.theta = 0.2;
    middle.beta = middle.next_beta = 0.6;
    upload(b, &middle, state_.view());
  }

  ApgdPasses<R, Real> passes() { return {problem_, gamma, velocity, metric, state_.data()}; }

  void contact_pass(B& b) {
    reduce<Sums<2>>(b, problem_.contact_count, passes().contact_pass(),
                    ApgdContactFinish{state_.data()});
  }
  /// Without acceptance.
  void body_pass(B& b, Span<Sums<1>> energy) {
    reduce<Sums<1>>(b, problem_.bodies.owned_count, passes().body_pass(),
                    StoreResult<Sums<1>>{energy.data});
  }
  /// Trials of the line search, accepted or not, as a solve runs them.
  void iterate(B& b, int count) { iteration_.run(b, passes(), count, -1); }
  /// The same as two passes each.
  void iterate_plainly(B& b, int count) {
    for (int k = 0; k < count; ++k) apgd_trial(b, passes());
  }
  void residual_pass(B& b, ApgdCheck* check) {
    reduce<ResidualSums>(b, problem_.contact_count,
                         ApgdResidual<R, Real>{problem_, gamma, velocity, state_.data()},
                         ApgdCheckFinish{state_.data(), check});
  }

  ApgdImpulses<Real> gamma;
  ApgdVelocities<Real> velocity;
  StoredMetric<R, Real> metric;

 private:
  ContactProblem<Real> problem_;
  std::vector<Buffer<B, Vec3<Real>>> impulses_;
  std::vector<Buffer<B, Twist<Real>>> twists_;
  Buffer<B, Real> metric_;
  Buffer<B, ApgdState> state_;
  ApgdIteration<B> iteration_;
};

/// Metrics that are measured: both in float, only the default in double.
template <class Real>
std::vector<ApgdMetricKind> metric_kinds() {
  if (sizeof(Real) == 8) return {apgd_metric({})};
  return {ApgdMetricKind::diagonal, ApgdMetricKind::euclidean};
}

/// Name of a benchmark's variant: the default metric is not named.
template <class Real>
std::string variant_name(ApgdMetricKind kind) {
  const std::string real = sizeof(Real) == 4 ? "float" : "double";
  return kind == apgd_metric({}) ? real : real + "_euclidean";
}

/// The metric as a solver takes it.
inline ParameterValues own_of(ApgdMetricKind kind) {
  return {{kApgdMetric.key, static_cast<double>(kind)}};
}

}  // namespace scree::bench
