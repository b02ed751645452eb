// Whole APGD iterations on a bed: the two passes and their scalar updates alone, and the solver
// itself with its residual checks. Both report the residual reached:
// a speed without it is not a result.

#include <utility>

#include "bench/apgd_arrays.h"
#include "bench/suite.h"
#include "solvers/apgd.h"

namespace scree::bench {
namespace {

constexpr int kCheckEvery = 10;

/// Whether the backend's tuned twin reads impulses and twists once for both passes.
template <class B, class Real>
constexpr bool is_fused() {
  return B::kIsDevice && sizeof(Real) == 4;
}

/// RMS residual of impulses, evaluated like any solver's.
template <class B, class Real>
double residual_rms(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> gamma) {
  Buffer<B, Twist<Real>> velocity(b, p.bodies.count);
  for_each(b, p.bodies.count, StartVelocity<Real>{p, velocity.view(p.bodies.count)});
  for_each(b, p.bodies.owned_count,
           BodyVelocity<RadialRows<Real>, Real>{p, gamma, velocity.view()});
  ResidualEvaluator<B, Real> evaluator(b);
  return evaluator
      .template evaluate<RadialRows<Real>>(b, p, gamma,
                                           std::as_const(velocity).view(p.bodies.count))
      .rms;
}

/// Iterations as Apgd runs them between checks: from a random guess on, with momentum, restarts and
/// rejected trials.
/// @param plain  contact pass and body pass in turn instead of the backend's tuned twin
template <class B, class Real>
void run_iteration(Suite<B>& suite, benchmark::State& state, Index spheres, ApgdMetricKind kind,
                   bool plain) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<Real>(spheres);
  ApgdArrays<B, Real> arrays(b, bed, kind);
  const double first =
      residual_rms(b, bed.problem(), Span<const Vec3<Real>>(arrays.gamma.current(0)));
  double applications = 0;
  const Traffic traffic =
      kCheckEvery * (is_fused<B, Real>() && !plain ? apgd_fused_iteration_traffic()
                                                   : apgd_iteration_traffic(sizeof(Real), kind));
  Work work = Suite<B>::contact_work(bed, traffic);
  work.items *= kCheckEvery;
  suite.measure(state, work, [&] {
    plain ? arrays.iterate_plainly(b, kCheckEvery) : arrays.iterate(b, kCheckEvery);
    applications += kCheckEvery;
  });
  Suite<B>::report_size(state, bed);
  Buffer<B, ApgdCheck> check(b, 1);
  arrays.residual_pass(b, check.data());
  const Index last = fetch(b, check.data()).state.accepted;
  const double reached =
      residual_rms(b, bed.problem(), Span<const Vec3<Real>>(arrays.gamma.current(last)));
  state.counters["applications"] = applications;
  state.counters["residual_rms"] = reached;
  if (!(reached < first)) state.SkipWithError("the residual did not fall");
}

/// Cost of one more iteration of a solve, residual checks included: a long solve minus a short
/// one, over the difference of their operator applications.
template <class B, class Real>
void run_solve(Suite<B>& suite, benchmark::State& state, Index spheres, ApgdMetricKind kind) {
  constexpr int kShort = kCheckEvery;
  constexpr int kLong = (B::kIsDevice ? 11 : 2) * kCheckEvery;
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<Real>(spheres);
  const Index n = bed.contact_count();
  Buffer<B, Vec3<Real>> guess(b, n), gamma(b, n);
  bed.random_impulses(b, 51, guess.view(n));
  const auto make = [&](int iterations) {
    return make_solver<B, Real>(
        "apgd", {.max_iterations = iterations, .check_every = kCheckEvery, .own = own_of(kind)});
  };
  const auto short_solver = make(kShort), long_solver = make(kLong);
  SolveStats stats;
  const auto solve = [&](Solver<B, Real>& solver) {
    copy(b, std::as_const(guess).view(n), gamma.view(n));
    solver.restore_memory({});
    stats = solver.solve(b, bed.problem(), gamma.view(n), 0);
  };
  const auto solve_short = [&] { solve(*short_solver); };
  const auto solve_long = [&] { solve(*long_solver); };
  solve_long();
  const int applications = stats.applications - kShort;
  const SolveStats reached = stats;
  solve_short();
  const int runs = B::kIsDevice ? 1 : suite.runs_per_batch(solve_short);
  if (stats.applications != kShort) return state.SkipWithError("the solver stopped early");
  std::vector<double> seconds;
  for (auto _ : state) {
    const double of_short = suite.seconds_of(solve_short, runs);
    const double of_long = suite.seconds_of(solve_long, runs);
    seconds.push_back((of_long - of_short) / runs / applications);
    state.SetIterationTime(std::max(seconds.back(), 0.0));
  }
  state.counters["runs_per_batch"] = runs;
  const Traffic traffic = (is_fused<B, Real>() ? apgd_fused_iteration_traffic()
                                               : apgd_iteration_traffic(sizeof(Real), kind)) +
                          (1.0 / kCheckEvery) * residual_traffic(sizeof(Real));
  suite.report(state, Suite<B>::contact_work(bed, traffic), seconds);
  Suite<B>::report_size(state, bed);
  state.counters["applications"] = reached.applications;
  state.counters["residual_rms"] = reached.residual.rms;
}

template <class B, class Real>
void add_typed_apgd(Suite<B>& suite, Index n) {
  using S = Suite<B>;
  using State = benchmark::State;
  for (const ApgdMetricKind kind : metric_kinds<Real>()) {
    suite.add("apgd_iteration", variant_name<Real>(kind), n,
              [n, kind](S& s, State& state) { run_iteration<B, Real>(s, state, n, kind, false); });
    if (B::kIsDevice) {
      suite.add("apgd_plain_iteration", variant_name<Real>(kind), n,
                [n, kind](S& s, State& state) { run_iteration<B, Real>(s, state, n, kind, true); });
    }
    suite.add("apgd_solve", variant_name<Real>(kind), n,
              [n, kind](S& s, State& state) { run_solve<B, Real>(s, state, n, kind); });
  }
}

}  // namespace

void add_apgd(Suite<BenchBackend>& suite, Index spheres) {
  add_typed_apgd<BenchBackend, float>(suite, spheres);
  add_typed_apgd<BenchBackend, double>(suite, spheres);
}

}  // namespace scree::bench
