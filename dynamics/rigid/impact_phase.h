#pragma once
// Impacts of a step by Poisson's hypothesis, before the step's own contact problem: rounds of
// compression and release on the contacts that bounce and on those that touch them, and on all joints.
// docs/theory.md, section "Impacts". Memory: 16 bytes a contact and 4 a body while a round searches
// for impacts; what else it takes goes with the contacts that take part.

#include <cmath>

#include "dynamics/rigid/collision_settings.h"
#include "dynamics/rigid/joints.h"
#include "dynamics/rigid/problem_assembly.h"
#include "kernels/step/impact_pass.h"
#include "solvers/solver.h"

namespace scree {

/// Instantiated beside the other solvers: solvers/impact.h.
template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_impact(const SolverParams& params);

/// What the impacts of a step took.
struct ImpactStats {
  ImpactSums before;  ///< of the contacts as the step found them
  int rounds = 0;
  int iterations = 0;
  int applications = 0;
  bool converged = true;
};

/// Impulses of one round, with those of its joints behind them.
template <class B, class Real>
struct ImpactImpulses {
  Index count = 0;
  Buffer<B, Index> contact;     ///< of the step's contacts
  Buffer<B, Vec3<Real>> gamma;  ///< as many vectors a contact as the layout has [N s]
};

template <class B, class Real>
class ImpactPhase {
 public:
  explicit ImpactPhase(B& b, const Scene& scene, ContactLayout layout)
      : sums_(b, 1),
        changes_(b, 1),
        layout_(layout),
        period_(periodic_box(scene.periodicity).length),
        exact_(scene.solver.exact_coulomb),
        absolute_(scene.solver.stop.level == StopRule::Level::absolute ? scene.solver.stop.residual
                                                                       : 0) {
    SolverParams params;
    params.max_iterations = scene.solver.max_iterations;
    params.check_every = scene.solver.check_every;
    solver_ = make_impact<B, Real>(params);
  }

  /// With several ranks: run() is then a call that all make together.
  void set_ghosts(const Ghosts<B>* ghosts) {
    ghosts_ = ghosts;
    solver_->set_ghosts(ghosts);
  }

  /// Gives bodies the velocities that they have after their impacts; loads come later.
  /// @param joints     after place()
  /// @param envelope   up to which contacts are listed [m]
  /// @param load_gain  what loads beside gravity will add to velocities [m/s]; empty: nothing
  ImpactStats run(B& b, ProblemAssembly<B, Real>& assembly, Joints<B, Real>& joints,
                  const BodyView<Real>& bodies, const ContactView<Real>& contacts,
                  const SteppingSettings& stepping, double envelope, const Vec3<Real>& gravity_step,
                  Span<const Vec3<Real>> load_gain) {
    forget();
    ImpactStats stats;
    ImpactTest<Real> test;
    test.bodies = bodies;
    test.contacts = contacts;
    test.law = assembly.laws();
    test.time_step = static_cast<Real>(stepping.time_step);
    test.threshold = static_cast<Real>(stepping.restitution_threshold);
    test.touching_gap = static_cast<Real>(kTouching * envelope);
    test.lifts = !exact_;
    test.gravity_step = gravity_step;
    test.load_gain = load_gain;
    while (stats.rounds < kRounds && round(b, {assembly, joints, stepping}, test, stats))
      ++stats.rounds;
    return stats;
  }

  void forget() { impulses_.clear(); }
  /// Impulses of the last run, round by round.
  const std::vector<ImpactImpulses<B, Real>>& impulses() const { return impulses_; }

 private:
  /// Impacts one after the other within a step.
  static constexpr int kRounds = 8;
  /// Bodies one behind the other that take part in an impact because they touch.
  static constexpr int kReach = 4;
  /// Gap of bodies that touch, over the envelope.
  static constexpr double kTouching = 0.01;
  /// RMS residual of the impacts, over their RMS approach speed.
  static constexpr double kTolerance = 1e-3;
  /// The same over the speed below which nothing bounces; the larger of the two counts.
  static constexpr double kShareOfThreshold = 0.1;
  /// Rounds end when the squares of the approach speeds are this small, over those of the first.
  static constexpr double kRest = 1e-4;
  /// Most corrections of the bias for exact Coulomb friction.
  static constexpr int kCorrections = 30;

  /// The problem of one round and the memory that it points at.
  struct Round {
    Round(B& b, Index contacts)
        : step(b), shifted(b, contacts), restitution(b, contacts), least(b, contacts) {}
    StepProblem<B, Real> step;
    Buffer<B, Real> shifted, restitution, least;
  };

  /// What makes problems.
  struct Makers {
    ProblemAssembly<B, Real>& assembly;
    Joints<B, Real>& joints;
    const SteppingSettings& stepping;
  };

  bool round(B& b, const Makers& makers, const ImpactTest<Real>& test, ImpactStats& stats) {
    const auto& [assembly, joints, stepping] = makers;
    const Index n = test.contacts.count;
    Buffer<B, Index> takes_part(b, n);
    ImpactSums sums;
    {
      Buffer<B, float> reached(b, test.bodies.moving_count);
      fill(b, reached.view(), 0.0f);
      find(b, {test, kReach + 1.0f, takes_part.view(), reached.view()});
      sums = fetch(b, sums_.data());
      if (stats.rounds == 0) stats.before = sums;
      const double enough = kRest * stats.before.approach_squares;
      if (!(sums.bouncing > 0) || sums.approach_squares < enough) return false;
      for (int k = 0; k < kReach; ++k) {
        if (ghosts_ != nullptr) ghosts_->update(b, reached.view());
        const auto least = static_cast<float>(kReach + 1 - k);
        for_each(b, n, SpreadImpacts<Real>{test, least, takes_part.view(), reached.view()});
        if (joints.count() > 0) joints.spread_impacts(b, test.bodies, least, reached.view());
      }
    }
    Buffer<B, Offset> place(b, static_cast<Offset>(n) + 1);
    exclusive_scan(b, Span<const Index>(takes_part.view(n)), place.view());
    const auto count = static_cast<Index>(fetch(b, place.data() + n));

    const auto radial = static_cast<Index>(fetch(b, place.data() + test.contacts.radial_count));
    Round r(b, count);
    ImpactImpulses<B, Real> found{count, Buffer<B, Index>(b, count),
                                  Buffer<B, Vec3<Real>>(b, vectors(count) + joints.vectors())};
    ContactProblem<Real>& p = r.step.problem;
    p.layout = layout_;
    p.contact_count = count;
    if (layout_ == ContactLayout::mixed) p.radial_count = radial;
    p.bodies = test.bodies.ranges();
    if (layout_ == ContactLayout::jointed) ++p.bodies.count;  // the world
    ContactParts parts(layout_);
    parts.bias = parts.friction = true;
    r.step.contacts.resize_discard(parts, count, radial);
    point_to(p, r.step.contacts);
    for_each(b, n,
             GatherImpacts<Real>{test, takes_part.view(), place.view(), found.contact.view(),
                                 layout_, radial, r.step.contacts.spans(), r.restitution.view()});
    assembly.set_bodies(b, test.bodies, {}, r.step);
    r.step.lists.build(b, p);
    const Span<Vec3<Real>> gamma = found.gamma.view(vectors(count) + joints.vectors());
    fill(b, gamma, Vec3<Real>{});
    if (joints.count() > 0) joints.join_impacts(b, test.bodies, stepping, period_, r.step, gamma);
    assembly.share(b, r.step);

    double tolerance = std::max(kTolerance * std::sqrt(sums.approach_squares / p.contacts_in_all()),
                                kShareOfThreshold * static_cast<double>(test.threshold));
    if (absolute_ > 0) tolerance = std::min(tolerance, absolute_);
    with_rows<Real>(layout_, [&](auto rows) {
      using R = decltype(rows);
      solve<R>(b, r, gamma, tolerance, stats);
      for_each(b, count,
               ReleaseImpacts<R, Real>{p, r.restitution.view(), solver_->velocity(), gamma,
                                       r.least.view()});
      p.adhesion.values = r.least.view();
      solve<R>(b, r, gamma, tolerance, stats);
    });
    for_each(b, test.bodies.owned_count, TakeVelocities<Real>{p, solver_->velocity(), test.bodies});
    solver_->forget_velocity();
    joints.keep_impacts(b, test.bodies, gamma);
    if (ghosts_ != nullptr) ghosts_->update(b, test.bodies.velocity, test.bodies.angular_velocity);
    impulses_.push_back(std::move(found));
    return true;
  }

  void find(B& b, const FindImpacts<Real>& impacts) {
    const ContactView<Real>& contacts = impacts.test.contacts;
    const StoreResult<ImpactSums> finish{sums_.data()};
    if (ghosts_ == nullptr) {
      reduce<ImpactSums>(b, contacts.count, impacts, finish);
    } else {
      reduce_on_ranks<ImpactSums>(
          b, contacts.count,
          CountedOnce<FindImpacts<Real>>{impacts, contacts.body_a, contacts.body_b,
                                         impacts.test.bodies.ranges()},
          finish);
    }
  }

  template <class R>
  void solve(B& b, Round& r, Span<Vec3<Real>> gamma, double tolerance, ImpactStats& stats) {
    const ContactProblem<Real>& p = r.step.problem;
    ContactProblem<Real> shifted = p;
    if (exact_) {
      copy(b, std::as_const(r.step.contacts.bias).view(p.own_contacts()), r.shifted.view());
      shifted.bias.values = r.shifted.view();
    }
    for (int k = 0;; ++k) {
      solver_->restore_memory({});  // the same answer whatever was solved before
      const SolveStats solved = solver_->solve(b, shifted, gamma, tolerance);
      stats.iterations += solved.iterations;
      stats.applications += solved.applications;
      const bool is_last = !exact_ || k == kCorrections;
      if (is_last) {
        stats.converged = stats.converged && solved.converged;
        return;
      }
      reduce_contacts<Sums<1>>(b, p, LiftBias<R, Real>{p, solver_->velocity(), r.shifted.view()},
                               StoreResult<Sums<1>>{changes_.data()});
      const double change = fetch(b, changes_.data()).value[0];
      if (std::sqrt(change / p.contacts_in_all()) <= tolerance) {
        stats.converged = stats.converged && solved.converged;
        return;
      }
    }
  }

  Offset vectors(Index contacts) const {
    return static_cast<Offset>(contacts) * vectors_per_contact(layout_);
  }

  std::unique_ptr<Solver<B, Real>> solver_;
  Buffer<B, ImpactSums> sums_;
  Buffer<B, Sums<1>> changes_;
  std::vector<ImpactImpulses<B, Real>> impulses_;
  const Ghosts<B>* ghosts_ = nullptr;
  ContactLayout layout_;
  Vec3d period_;  ///< zero: axis not periodic [m]
  bool exact_;
  double absolute_;  ///< the residual that the scene asks for [m/s], or 0
};

}  // namespace scree
