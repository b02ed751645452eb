#pragma once
// Accelerated multiplicative Schwarz: Nesterov's momentum around block Gauss-Seidel over tiles of
// bodies, each swept several times while its data is at hand. A third of the passes of APGD.
//
// Source: docs/theory.md, section "Accelerated Schwarz". Meant for many bodies of like size: every
// body has the tiles of all its contacts wait for each other, so one that touches hundreds of tiles
// makes hundreds of colors. Memory passes per iteration: one over contacts (normal and bias 16,
// link 8, two impulses 24 read, 12 written; float) and one over bodies (two twists 48 read, 24
// written, and 48 again for each further tile that touches the body, about half of them); sweeps
// run in shared memory on a device. At each check three passes over bodies and contacts more.

#include <algorithm>
#include <utility>

#include "kernels/solve/schwarz_iteration.h"
#include "solvers/check_schedule.h"
#include "solvers/expanded_problem.h"
#include "solvers/residual.h"
#include "solvers/solver_card.h"
#include "solvers/tile_coloring.h"

namespace scree {

template <class B, class Real>
class Schwarz final : public Solver<B, Real> {
 public:
  explicit Schwarz(const SolverParams& params) : params_(params) { validate(params_); }

  SolveStats solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                   double tolerance) override {
    if (p.layout == ContactLayout::mixed) return solve_expanded(b, p, gamma, tolerance);
    return with_rows_of_one_group<Real>(
        p.layout, [&](auto rows) { return run<decltype(rows)>(b, p, gamma, tolerance); });
  }

 private:
  static constexpr Index kTileBodies = 48;
  static constexpr int kSweeps = 2;
  /// A residual so many times the lowest one (it ripples) restarts the momentum, and ends it after
  /// so many times: sweeps without momentum always descend.
  static constexpr double kWorse = 100;
  static constexpr int kMostSetbacks = 3;

  /// Tiles are of one group.
  SolveStats solve_expanded(B& b, const ContactProblem<Real>& mixed, Span<Vec3<Real>> gamma,
                            double tolerance) {
    ExpandedProblem<B, Real> expanded(b, mixed);
    expanded.take_impulses(b, gamma);
    SolveStats stats =
        run<GeneralRows<Real>>(b, expanded.problem(), expanded.impulses(), tolerance);
    expanded.give_impulses(b, gamma);
    for (Index* contact : {&stats.residual.max_contact, &stats.residual.bad_contact})
      if (*contact >= 0) *contact = expanded.mixed_contact(b, *contact);
    return stats;
  }

  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance) {
    ContactPasses<R, B, Real>::project_impulses(b, p, gamma);
    const Span<Twist<Real>> velocity = this->start_velocity(b, p);
    if (p.contact_count == 0) return {0, 0, true, {}};

    Buffer<B, Vec3<Real>> other_gamma(b, R::vector_count(p));
    Buffer<B, Twist<Real>> other_velocity(b, p.bodies.count);
    Buffer<B, SchwarzState> state(b, 1);
    const SchwarzPasses<R, Real> passes{p,
                                        {gamma, other_gamma.view()},
                                        {velocity, other_velocity.view()},
                                        state.data(),
                                        static_cast<Real>(kRelaxation.of(params_.own)),
                                        kSweeps};
    TileColoring<B> tiles(b);
    SchwarzIteration<B, R, Real> iteration(b);
    ResidualEvaluator<B, Real> evaluator(b);
    CheckSchedule schedule(params_.check_every, tolerance);
    SolveStats stats;
    double lowest = -1;
    int setbacks = 0;
    for (;;) {
      const int k = stats.iterations;
      gather_velocities<R>(b, passes, k);
      stats.residual = evaluator.template evaluate<R>(b, p, passes.impulses(k).current,
                                                      passes.velocities(k).current);
      const double rms = stats.residual.rms;
      this->add_to_curve(k, stats.applications, rms);
      stats.converged = rms <= tolerance;
      const bool is_finite = stats.residual.bad_contact < 0;
      if (stats.converged || !is_finite || k >= params_.max_iterations) break;
      if (k == 0) {
        fill(b, state.view(), SchwarzState{});
        tiles.compute(b, p, kTileBodies);
        iteration.start(b, passes, tiles);
        stats.colors = tiles.color_count();
      }
      if (lowest < 0 || rms < lowest) lowest = rms;
      if (rms > kWorse * lowest)
        for_each(b, 1, SchwarzRestart{state.data(), ++setbacks > kMostSetbacks});
      const int block = std::min(schedule.next(k, rms), params_.max_iterations - k);
      iteration.run(b, passes, tiles, k, block);
      stats.iterations += block;
      stats.applications += block;
    }
    if (stats.iterations % 2 == 1) {
      copy(b, Span<const Vec3<Real>>(passes.gamma[1]), gamma);
      copy(b, Span<const Twist<Real>>(passes.velocity[1]), velocity);
    }
    stats.residual.objective -= evaluator.template impulse_energy<R>(b, p, velocity);
    return stats;
  }

  /// V of iterate k and of the one before from their impulses: increments pile up rounding errors.
  /// Both count: an extrapolated V that is not that of the extrapolated impulses takes three times
  /// as many passes in float.
  template <class R>
  static void gather_velocities(B& b, const SchwarzPasses<R, Real>& passes, int k) {
    const ContactProblem<Real>& p = passes.p;
    const Iterates<Vec3<Real>> impulses = passes.impulses(k);
    const Iterates<Twist<Real>> velocities = passes.velocities(k);
    const auto gather = [&](Span<const Vec3<Real>> from, Span<Twist<Real>> to) {
      ContactPasses<R, B, Real>::gather_velocities(b, p, from, to);
    };
    gather(impulses.current, passes.velocity[k % 2]);
    if (k == 0) {  // fixed bodies have their velocity in both
      copy(b, impulses.current, impulses.next);
      copy(b, velocities.current, velocities.next);
    } else {
      gather(impulses.next, velocities.next);
    }
  }

  SolverParams params_;
};

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_schwarz(const SolverParams& params) {
  return std::make_unique<Schwarz<B, Real>>(params);
}

/// ExpandedProblem.
inline HeldBytes expanded_memory(const SolverCase& c) {
  return {16 * c.real + 8, 12 + 3 * c.vec() + c.real + c.impulse()};
}

/// The iterate before; tiles, their neighbors and links; without tuned programs also the order, the
/// extrapolated point and the weights.
inline HeldBytes schwarz_memory(const SolverCase& c) {
  const double plain = 4 + c.impulse() + 3 * c.real;
  const bool is_tuned = c.on_device && c.is_radial();
  const HeldBytes own{2 * c.twist() + 14, c.impulse() + 20 + (is_tuned ? 0 : plain)};
  return c.is_mixed() ? own + expanded_memory(c) : own;
}

/// A pass whose sweeps run in fast memory (the tuned twin); the plain program, on the CPU, moves
/// more. Contact: normal 3R, bias R, link 8, two impulses 6R read, one 3R written. Body: two twists
/// 12R read, one 6R written; 12R more for each further tile that touches it, about half a tile.
/// @param r  size of a number [bytes]
constexpr Traffic schwarz_pass_traffic(double r) {
  const double contact = 13 * r + 8;
  return {contact, 18 * r, contact, 24 * r};
}
static_assert(schwarz_pass_traffic(4).contact_least == 16 + 8 + 24 + 12);
static_assert(schwarz_pass_traffic(4).body_least == 48 + 24);

constexpr SolverCard schwarz_card() {
  return {.name = "schwarz",
          .description =
              "accelerated Schwarz over tiles of bodies: for a million like spheres on a GPU",
          .parameters = kRelaxationParameters,
          .layouts = kContactLayouts,
          .memory = schwarz_memory,
          .traffic = [](const SolverCase& c) { return schwarz_pass_traffic(c.real); }};
}

}  // namespace scree
