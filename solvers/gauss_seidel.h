#pragma once
// Projected Gauss-Seidel in contact order, one 3x3 (6x6 with rolling friction) block at a time, on
// one CPU thread: the classic reference for convergence per sweep.
//
// Source: docs/theory.md, section "Gauss-Seidel and Jacobi"; Jourdan, Alart, Jean, CMAME 155, 1998
// (block relaxation). Memory passes per sweep: one over contacts in place, bodies read and written
// at each contact; at each check one pass over bodies and one over contacts more.

#include "kernels/solve/gauss_seidel_pass.h"
#include "solvers/relaxation.h"

namespace scree {

template <class B, class Real>
class GaussSeidel final : public RelaxationSolver<B, Real> {
  static_assert(!B::kIsDevice, "sequential Gauss-Seidel runs on the CPU");

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
    if (p.contact_count == 0) return {0, 0, true, {}};
    Buffer<B, ContactMetric<Real>> weights(b, p.contact_count);
    const Span<ContactMetric<Real>> metric = weights.view();
    for_each(b, p.contact_count, StoreBlockMetric<R, Real>{p, metric});

    const GaussSeidelPass<R, Real> pass{p, metric, velocity, gamma, this->relaxation()};
    // In order, which for_each() does not promise: this solver is for the CPU alone.
    const auto sweep = [&] { run_elements(pass, 0, p.contact_count); };
    return this->template iterate<R>(b, p, gamma, tolerance, velocity, sweep, [] {});
  }
};

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_gauss_seidel([[maybe_unused]] const SolverParams& params) {
  if constexpr (B::kIsDevice) {
    return nullptr;  // refused before, by the card
  } else {
    return std::make_unique<GaussSeidel<B, Real>>(params);
  }
}

constexpr SolverCard gauss_seidel_card() {
  return {.name = "gauss_seidel",
          .description = "block Gauss-Seidel, one contact after the other: for small scenes",
          .parameters = kRelaxationParameters,
          .layouts = kAllLayouts,
          .cpu_only = "it is sequential; use \"gauss_seidel_colored\"",
          .memory = relaxation_memory,
          .traffic = [](const SolverCase& c) { return gauss_seidel_sweep_traffic(c.real); }};
}

}  // namespace scree
