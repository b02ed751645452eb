#pragma once
// Accelerated projected gradient descent (Nesterov) with adaptive step and restart,
// the flagship solver.
//
// Source: Mazhar, Heyn, Negrut, Tasora, ACM TOG 34(3), 2015, algorithm "APGD", with other
// rules for step and momentum; docs/theory.md.
// Steps and projections are taken in a diagonal metric by default; the Euclidean one of the paper
// is the other choice. Memory passes per iteration: one over contacts (112 B in float, 48 of them
// gathered) and one over bodies (136 B and 52 B gathered per contact); one more contact pass at
// every residual check. L |gamma+ - y|_H of a trial goes with the residual, so that iterations end
// by themselves where it should be small enough, by what solves before have told; a check follows, two in most solves: one
// at the start, and that one. There is one at least each thirty times `check_every` iterations, each twenty where the solve
// before did not reach its tolerance.
// Where nothing is known yet, or iterations cannot end by themselves (those of doubles, and of general layouts on a CPU),
// it is each `check_every` iterations. In the second half of the
// iterations allowed there is also one where the residual should be half that of the best iterate.
// A rejected trial, which is rare, costs one more of both passes; `applications` counts all of
// them. Spheres take the tuned twins of kernels/solve.

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "kernels/solve/apgd_iteration.h"
#include "kernels/solve/coulomb_pass.h"
#include "solvers/check_schedule.h"
#include "solvers/loaded_block.h"
#include "solvers/residual.h"
#include "solvers/residual_gauge.h"
#include "solvers/solver_card.h"

namespace scree {

/// ApgdContactPass. Contact: normal 3R, bias R, ids 8, two impulses 6R, diagonal metric 2R (none
/// when Euclidean) read, one impulse 3R written. Twists of the extrapolated point, 6R a body: once
/// each, or two per contact.
/// @param r  size of a number [bytes]
constexpr Traffic apgd_contact_pass_traffic(double r, ApgdMetricKind kind) {
  const double streamed = (kind == ApgdMetricKind::diagonal ? 14 : 13) * r + 8;
  return {streamed, 6 * r, streamed + 12 * r, 0};
}

/// ApgdBodyPass. Body: v*, V, V_y 18R, inertia 2R, two list starts 8 read; V, V_y 12R written.
/// Solid spheres have v* from their rates, 6R and their radius, and one of mass and radius when all
/// are equal: then 2R less are read than counted here. Contact: impulse 3R and normal 3R, once each
/// or for both of its bodies; list entry 4.
constexpr Traffic apgd_body_pass_traffic(double r) {
  const double body = 32 * r + 8;
  return {6 * r + 4, body, 12 * r + 4, body};
}

/// One APGD iteration (one trial of the line search).
constexpr Traffic apgd_iteration_traffic(double r, ApgdMetricKind kind) {
  return apgd_contact_pass_traffic(r, kind) + apgd_body_pass_traffic(r);
}

/// One APGD iteration in float whose two passes are one, so that impulses and twists are read once
/// and V_y is worked out from two iterates: the least of any program here, for bodies and materials
/// alike. Doubles have no such program. Contact: normal, metric and A packed 8, bias R, B 4, two
/// impulses 6R, list entry 4 read, one impulse 3R written. Body: v* 6R, two V 12R, inertia 2R,
/// starts 8 read; V 6R written.
constexpr Traffic apgd_fused_iteration_traffic() {
  constexpr double r = sizeof(float);
  constexpr double contact = 10 * r + 16;
  constexpr double body = 26 * r + 8;
  return {contact, body, contact, body};
}

// The figures in the kernels' docstrings.
static_assert(apgd_contact_pass_traffic(4, ApgdMetricKind::diagonal).contact_least == 64);
static_assert(apgd_contact_pass_traffic(4, ApgdMetricKind::diagonal).contact_requested == 112);
static_assert(apgd_body_pass_traffic(4).contact_requested == 52);
static_assert(apgd_body_pass_traffic(4).body_least == 136);
static_assert(apgd_fused_iteration_traffic().contact_least == 56);
static_assert(apgd_fused_iteration_traffic().body_least == 112);

inline constexpr std::array kApgdMetricNames{"diagonal", "euclidean"};
inline constexpr SolverParameter kApgdMetric{
    .key = "metric",
    .description =
        "metric of its steps and projections. \"diagonal\" needs fewer iterations, most "
        "with mixed sizes; \"euclidean\" is the published method.",
    .choices = kApgdMetricNames};

inline ApgdMetricKind apgd_metric(const ParameterValues& values) {
  return static_cast<ApgdMetricKind>(kApgdMetric.of(values));
}

/// The rows of a layout, as they are.
template <class R>
struct PlainRows : std::type_identity<R> {};

/// @tparam RowsOf  RowsOf<R>::type are the contact rows in place of those of the layout, R
template <class B, class Real, template <class> class RowsOf = PlainRows>
class Apgd final : public Solver<B, Real> {
 public:
  explicit Apgd(const SolverParams& params) : params_(params) { validate(params_); }

  SolveStats solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                   double tolerance) override {
    return with_rows<Real>(p.layout, [&](auto rows) {
      return run<typename RowsOf<decltype(rows)>::type>(b, p, gamma, tolerance);
    });
  }
  std::vector<double> memory() const override {
    return {lipschitz_, gauge_.carried(), has_converged_ ? 1.0 : 0.0};
  }
  void restore_memory(const std::vector<double>& m) override {
    lipschitz_ = m.empty() ? 0 : m[0];
    gauge_.carry(m.size() < 2 ? 0 : m[1]);
    has_converged_ = m.size() > 2 && m[2] > 0;
  }

 private:
  /// Bytes: 48 a body and 16 a contact (radial layout of uniform bodies in float; by the tuned twins of a GPU 24 and 24, or
  /// about 24 and 40 where all stays in shared memory); 12 more a contact in the second half of the iterations allowed.
  struct Workspace {
    Workspace(B& b, Offset vectors, Index bodies)
        : impulses(b, vectors),
          best(b),
          iterate(b, bodies),
          extrapolated(b),
          metric(b),
          lift(b),
          bias(b),
          state(b, 1),
          check(b, 1),
          residual(b),
          iteration(b) {}
    Buffer<B, Vec3<Real>> impulses;  ///< the other buffer is the caller's
    Buffer<B, Vec3<Real>> best;
    Buffer<B, Twist<Real>> iterate;  ///< the other is velocity()
    Buffer<B, Twist<Real>> extrapolated;
    Buffer<B, Real> metric;
    Buffer<B, Real> lift;  ///< with the lifted law
    Buffer<B, Real> bias;
    Buffer<B, ApgdState> state;
    Buffer<B, ApgdCheck> check;
    ResidualEvaluator<B, Real> residual;
    ApgdIteration<B> iteration;
  };

  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance) {
    const Span<Twist<Real>> velocity = this->start_velocity(b, p);
    if (p.contacts_in_all() == 0) return {0, 0, true, {}};

    const Offset vectors = R::vector_count(p);
    Workspace w(b, vectors, p.bodies.count);
    const ApgdImpulses<Real> impulses{{gamma, w.impulses.view()}};
    ApgdState* state = w.state.data();
    ApgdPasses<R, Real> passes{p,  impulses, {{velocity, w.iterate.view()}, {}},
                               {}, state,    params_.law == ApgdLaw::coulomb};
    ApgdVelocities<Real>& velocities = passes.velocity;
    const bool is_lifted = params_.law == ApgdLaw::lifted;
    if (is_lifted) {
      w.lift.reserve_discard(p.own_contacts());
      w.bias.reserve_discard(p.own_contacts());
      passes.p.bias = ContactBias<Real>(w.bias.view(p.own_contacts()));
      passes.has_moving_bias = true;
    }
    if (w.iteration.stores_extrapolated(passes)) {
      w.extrapolated.reserve_discard(p.bodies.count);
      velocities.of_extrapolated = w.extrapolated.view();
    }
    // Bodies that do not move keep this velocity through the whole solve.
    const auto start_from_guess = [&] {
      copy(b, Span<const Vec3<Real>>(gamma), impulses.buffer[1]);
      ContactPasses<R, B, Real>::gather_velocities(b, p, gamma, velocity);
      this->update_ghosts(b, velocity);
      for (const Span<Twist<Real>>& view : {velocities.of_iterate[1], velocities.of_extrapolated}) {
        if (!view.empty()) copy(b, Span<const Twist<Real>>(velocity), view);
      }
    };
    ContactPasses<R, B, Real>::project_impulses(b, p, gamma);
    start_from_guess();
    const bool is_diagonal = apgd_metric(params_.own) == ApgdMetricKind::diagonal;
    if (is_diagonal) {
      const Offset values =
          static_cast<Offset>(p.contact_count) * StoredMetric<R, Real>::per_contact(p);
      w.metric.reserve_discard(values);
      passes.metric = StoredMetric<R, Real>::on(p, w.metric.view());
    }
    reduce_over_ranks<Largest<double>>(b, p.contact_count, ApgdMetric<R, Real>{p, passes.metric},
                                       ApgdStart{state, lipschitz_});
    bool is_unlifted = is_lifted;
    const auto follow_lift = [&] {
      for_each(b, p.own_contacts(),
               FollowLift<R, Real>{p, impulses, velocities, state, w.lift.view(p.own_contacts()),
                                   w.bias.view(p.own_contacts()), is_unlifted});
      is_unlifted = false;
    };
    if (is_lifted) follow_lift();
    w.iteration.start(b, passes, is_diagonal ? this->ghosts() : nullptr);
    gauge_.start_solve();

    SolveStats stats;
    ResidualSums own;  // of the last iterate
    const double root_count = std::sqrt(p.contacts_in_all());
    double best = -1;
    bool is_guess = true, is_best = true;
    int next_block = params_.max_iterations / kBlocks;
    LoadedBlock<B, Real> loaded(b);
    ApgdCheck* const found = w.check.data();
    const bool has_blocks = tolerance > 0 && !passes.exact && !this->is_over_ranks() &&
                            LoadedBlock<B, Real>::template takes<R>(p);
    if (has_blocks) LoadedBlock<B, Real>::template queue_contrast<R>(b, p, &found->contrast);
    CheckSchedule schedule(kPatience * params_.check_every, tolerance);
    for (;;) {
      // The host reads the residual, the only synchronization of the loop.
      reduce_contacts<ResidualSums>(b, p, ApgdResidual<R, Real>{p, impulses, velocities, state},
                                    ApgdCheckFinish{state, found});
      reduce_over_ranks<Sums<1>>(b, p.bodies.owned_count,
                                 ApgdImpulseEnergy<R, Real>{p, velocities, state},
                                 StoreResult<Sums<1>>{&found->energy});
      const ApgdCheck check = fetch(b, static_cast<const ApgdCheck*>(found));
      const double energy = check.energy.value[0];
      own = check.own_residual;
      if (has_blocks) loaded.take_contrast(check.contrast);
      const Residual residual =
          ResidualEvaluator<B, Real>::from_sums(check.residual, p.contacts_in_all());
      const double rms = params_.law == ApgdLaw::convex ? residual.rms : residual.exact_rms;
      if (std::exchange(is_guess, false) && rms > tolerance) {
        // Impulses that grew while bodies were jammed between prescribed ones are far too large
        // once they come free. Many iterations would take them back; one scaling does it.
        const double scale = best_scale(residual.objective, energy);
        if (scale < 0.5) {
          for_each(b, static_cast<Index>(gamma.size),
                   ScaleImpulses<Real>{gamma, static_cast<Real>(scale)});
          start_from_guess();
          continue;
        }
      }
      stats.iterations = check.state.accepted;
      stats.applications = check.state.trials;
      gauge_.note(check.state.measure / root_count, rms);
      lipschitz_ = check.state.lipschitz;
      this->add_to_curve(stats.iterations, stats.applications, rms);
      stats.converged = rms <= tolerance;
      const bool finite = residual.bad_contact < 0;
      const bool is_last =
          stats.converged || !finite || stats.applications >= params_.max_iterations;
      // Until the end is near, better iterates are still to come: none is put aside.
      is_best = best < 0 || rms < best;
      if (is_best && (is_last || 2 * stats.applications >= params_.max_iterations)) {
        best = rms;
        stats.residual = residual;
        stats.residual.objective -= energy;
        const Span<const Vec3<Real>> here = impulses.current(check.state.accepted);
        if (!is_last) {
          w.best.reserve_discard(vectors);
          copy(b, here, w.best.view());
        } else if (here.data != gamma.data) {
          copy(b, here, gamma);
        }
      }
      if (is_last) break;
      if (has_blocks && stats.applications >= next_block) {
        next_block += params_.max_iterations / kBlocks;
        const Span<Vec3<Real>> here = impulses.current(stats.iterations);
        if (loaded.template solve<R>(b, passes.p, here, velocities.iterate(stats.iterations),
                                     tolerance)) {
          if (here.data != gamma.data) copy(b, Span<const Vec3<Real>>(here), gamma);
          start_from_guess();
          for_each(b, 1, ApgdResume{state});
          continue;
        }
      }

      const bool stops = !is_lifted && (this->is_over_ranks() || w.iteration.stops(passes));
      // Checks are where loaded contacts are solved.
      const bool is_sure = stops && gauge_.is_known() && !loaded.may_find();
      // Steps are much like those before.
      const bool will_end = is_sure && has_converged_;
      schedule.set_longest((will_end  ? kLongPatience
                            : is_sure ? kMediumPatience
                                      : kPatience) *
                           params_.check_every);
      const int wait = schedule.next(stats.applications, rms);
      const int left = params_.max_iterations - stats.applications;
      const int to_half = (params_.max_iterations + 1) / 2 - stats.applications;
      const bool is_late = to_half <= 0;
      // Trials end where the tolerance should be reached, and in the second half where an iterate
      // is worth keeping. A check is due otherwise if that is not met for long.
      // Where trials cannot end or their level is not known yet, checks are frequent.
      const double aim =
          is_late && !this->is_recorded() ? std::max(tolerance, kWorth * best) : tolerance;
      const double enough = stops ? root_count * gauge_.level(aim) : -1;
      int most = wait + wait / 4 + 1;
      if (this->is_recorded() || !stops || (enough < 0 && aim > 0)) {
        most = std::min(wait, params_.check_every);
      } else if (!is_late && !will_end) {
        most = std::min(most, to_half);
      }
      most = std::min(most, left);
      const auto run_trials = [&](int count, double down_to) {
        if (this->is_over_ranks() && !w.iteration.meets_ranks()) {
          run_over_ranks(b, w.iteration, passes, count, down_to);
        } else {
          w.iteration.run(b, passes, count, down_to);
        }
      };
      if (!is_lifted) {
        run_trials(most, enough);
        continue;
      }
      for (int done = 0; done < most; done += kLiftEvery) {
        follow_lift();
        run_trials(std::min(kLiftEvery, most - done), -1);
      }
    }
    if (is_best) {  // the last iterate, whose velocities and residual are at hand
      const Span<const Twist<Real>> last = velocities.iterate(stats.iterations);
      if (last.data != velocity.data) copy(b, last, velocity);
      if (this->is_over_ranks()) {
        const Residual here = ResidualEvaluator<B, Real>::from_sums(own, p.contacts_in_all());
        ResidualEvaluator<B, Real>::set_own(here, stats.residual);
      }
    } else {
      copy(b, Span<const Vec3<Real>>(w.best.view()), gamma);
      ContactPasses<R, B, Real>::gather_velocities(b, p, gamma, velocity);
      this->update_ghosts(b, velocity);
      stats.residual = w.residual.template evaluate_with_objective<R>(b, p, gamma, velocity);
      w.residual.template add_own<R>(b, p, gamma, velocity, stats.residual);
    }
    has_converged_ = stats.converged;
    return stats;
  }

  /// Trials on problems that ranks share: after each one exchange of the velocities found and one of sums. Ghosts
  /// extrapolate their velocities as their owners do, from the same numbers. Every rank works out the next state by
  /// itself, and has the same.
  template <class R>
  void run_over_ranks(B& b, ApgdIteration<B>& iteration, const ApgdPasses<R, Real>& a, int count,
                      double enough) {
    const BodyRanges& bodies = a.p.bodies;
    ApgdState state = fetch(b, static_cast<const ApgdState*>(a.state));
    for (int k = 0; k < count; ++k) {
      iteration.queue_trial(b, a);
      const Span<Twist<Real>> next = a.velocity.iterate(state.accepted + 1);
      this->ghosts()->send(b, next);
      const ApgdSums sums = combined(*b.ranks(), iteration.take_sums(b, a));
      this->ghosts()->receive(b, next);
      if (iteration.stores_extrapolated(a))
        for_each(b, bodies.moving_count - bodies.owned_count,
                 ApgdGhostPass<Real>{bodies.owned_count, a.velocity, a.state});
      ApgdContactFinish{&state}(sums.contacts);
      ApgdBodyFinish{&state, a.exact}(sums.bodies);
      fill(b, Span<ApgdState>{a.state, 1}, state);
      if (!(state.measure > enough)) break;
    }
  }

  /// The factor of gamma, 0 to 1, at which the objective is smallest.
  /// @param work    gamma . (N gamma + r) [J]
  /// @param energy  1/2 gamma . N gamma [J]
  static double best_scale(double work, double energy) {
    return energy > 0 ? std::clamp(1 - work / (2 * energy), 0.0, 1.0) : 1;
  }

  /// Loaded contacts are solved exactly this many times in a solve, less one.
  static constexpr int kBlocks = 6;
  static constexpr int kLiftEvery = 5;  ///< iterations between two moves of the lift
  /// Iterations between residual checks, over check_every: where loaded contacts are solved at them; where trials stop by
  /// themselves; and where they did so the last time.
  static constexpr int kPatience = 5, kMediumPatience = 20, kLongPatience = 30;
  /// Residual of an iterate that is worth a check, over that of the best one so far.
  static constexpr double kWorth = 0.5;

  SolverParams params_;
  double lipschitz_ = 0;
  ResidualGauge gauge_;
  bool has_converged_ = false;  ///< the solve before
};

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_apgd(const SolverParams& params) {
  return std::make_unique<Apgd<B, Real>>(params);
}

/// The other iterate and, once half of the iterations allowed are done, the best one; velocities of
/// both and, without the tuned program, of the extrapolated point.
inline HeldBytes apgd_memory(const SolverCase& c) {
  const bool has_spheres = c.is_radial() || c.is_mixed();
  const bool is_fused = c.on_device && has_spheres && c.real == 4;
  // Impulses and arms once more in records of 16 bytes, for the tuned program of general contacts.
  const bool is_wide = c.on_device && c.layout == ContactLayout::general && c.real == 4;
  const bool is_diagonal = apgd_metric(c.parameters) == ApgdMetricKind::diagonal;
  const double metric = (c.uniform ? 1 : has_spheres ? 2 : 3) * c.real;
  return {(is_fused ? 2 : 3) * c.twist(),
          2 * c.impulse() + (is_fused ? 8 : 0) + (is_wide ? 48 : 0) + (is_diagonal ? metric : 0)};
}

inline constexpr std::array kApgdParameters{kApgdMetric};

constexpr SolverCard apgd_card() {
  return {.name = "apgd",
          .description = "accelerated projected gradient descent: for everything",
          .parameters = kApgdParameters,
          .layouts = kAllLayouts,
          .steps_to_coulomb = true,
          .over_ranks = true,
          .memory = apgd_memory,
          .traffic = [](const SolverCase& c) {
            return c.real == 4 ? apgd_fused_iteration_traffic()
                               : apgd_iteration_traffic(c.real, apgd_metric(c.parameters));
          }};
}

}  // namespace scree
