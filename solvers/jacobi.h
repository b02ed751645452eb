#pragma once
// Projected Jacobi in the mass-split metric: every contact at once, descent guaranteed.
//
// With k_i contacts on body i, N <= P = blockdiag(k_a N_c,a + k_b N_c,b), so the objective falls
// for every relaxation below 2. Source: docs/theory.md, section "Gauss-Seidel and Jacobi"; mass
// splitting: Tonge, Benevolenski, Voroshilov, ACM TOG 31(4), 2012. Memory passes per iteration: one
// over contacts (108 B in float, 48 of them gathered) and one over bodies (64 B and 52 B gathered
// per contact); one more contact pass every `check_every` iterations.

#include "kernels/solve/jacobi_pass.h"
#include "solvers/relaxation.h"

namespace scree {

/// One iteration. Contact: normal 3R, bias R, ids 8, metric 3R, impulse 3R read, 3R written. Twists
/// 6R a body: once each, or two per contact. Bodies as in BodyVelocity.
/// @param r  size of a number [bytes]
constexpr Traffic jacobi_iteration_traffic(double r) {
  const double streamed = 13 * r + 8;
  return Traffic{streamed, 6 * r, streamed + 12 * r, 0} + body_velocity_traffic(r);
}
static_assert(jacobi_iteration_traffic(4).contact_requested == 108 + 52);
static_assert(jacobi_iteration_traffic(4).body_requested == 64);

template <class B, class Real>
class Jacobi final : public RelaxationSolver<B, Real> {
 public:
  using RelaxationSolver<B, Real>::RelaxationSolver;

  SolveStats solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                   double tolerance) override {
    return with_rows<Real>(p.layout,
                           [&](auto rows) { return run<decltype(rows)>(b, p, gamma, tolerance); });
  }

 private:
  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance) {
    const Span<Twist<Real>> velocity = this->template begin<R>(b, p, gamma);
    if (p.contacts_in_all() == 0) return {0, 0, true, {}};
    Buffer<B, ContactMetric<Real>> weights(b, p.contact_count);
    const Span<ContactMetric<Real>> metric = weights.view();
    for_each(b, p.contact_count, StoreMassSplitMetric<R, Real>{p, metric});

    bool is_current = false;  // V belongs to gamma
    const auto sweep = [&] {
      if (!is_current) {
        ContactPasses<R, B, Real>::gather_velocities(b, p, gamma, velocity);
        this->update_ghosts(b, velocity);
      }
      for_each(b, p.contact_count,
               JacobiPass<R, Real>{p, metric, velocity, gamma, this->relaxation()});
      is_current = false;
    };
    // The check that follows gathers V, which serves the next sweep.
    const auto collect = [&] { is_current = true; };
    return this->template iterate<R>(b, p, gamma, tolerance, velocity, sweep, collect);
  }
};

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_jacobi(const SolverParams& params) {
  return std::make_unique<Jacobi<B, Real>>(params);
}

constexpr SolverCard jacobi_card() {
  return {.name = "jacobi",
          .description = "projected Jacobi, every contact at once: for comparisons",
          .parameters = kRelaxationParameters,
          .layouts = kAllLayouts,
          .over_ranks = true,
          .memory = relaxation_memory,
          .traffic = [](const SolverCase& c) { return jacobi_iteration_traffic(c.real); }};
}

}  // namespace scree
