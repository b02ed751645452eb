#pragma once
// A solver of steps that is not in the list of solvers/: Jacobi steps of one size, the safe one or
// a part of it, without moments and without groups of contacts. tests/cli/extra_solver_test.cpp shows that the program knows it.

#include "kernels/solve/jacobi_pass.h"
#include "solvers/relaxation.h"
#include "solvers/solver_card.h"

namespace scree {

inline constexpr SolverParameter kDamping{.key = "damping",
                                          .description = "part of the safe step [-].",
                                          .standard = 0.8,
                                          .low = 0,
                                          .high = 1};

template <class B, class Real>
class DampedJacobi final : public RelaxationSolver<B, Real> {
 public:
  explicit DampedJacobi(const SolverParams& params)
      : RelaxationSolver<B, Real>(params), step_(static_cast<Real>(kDamping.of(params.own))) {}

  SolveStats solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                   double tolerance) override {
    if (p.layout == ContactLayout::radial) return run<RadialRows<Real>>(b, p, gamma, tolerance);
    return run<GeneralRows<Real>>(b, p, gamma, tolerance);
  }

 private:
  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance) {
    const Span<Twist<Real>> velocity = this->template begin<R>(b, p, gamma);
    if (p.contact_count == 0) return {0, 0, true, {}};
    Buffer<B, ContactMetric<Real>> weights(b, p.contact_count);
    const Span<ContactMetric<Real>> metric = weights.view();
    for_each(b, p.contact_count, StoreMassSplitMetric<R, Real>{p, metric});
    const auto sweep = [&] {
      for_each(b, p.contact_count, JacobiPass<R, Real>{p, metric, velocity, gamma, step_});
      for_each(b, p.bodies.owned_count, BodyVelocity<R, Real>{p, gamma, velocity});
    };
    return this->template iterate<R>(b, p, gamma, tolerance, velocity, sweep, [] {});
  }

  Real step_;
};

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_damped_jacobi(const SolverParams& params) {
  return std::make_unique<DampedJacobi<B, Real>>(params);
}

inline constexpr std::array kDampedJacobiParameters{kDamping};
inline constexpr std::array kDampedJacobiLayouts{ContactLayout::radial, ContactLayout::general};

constexpr SolverCard damped_jacobi_card() {
  return {
      .name = "damped_jacobi",
      .description = "Jacobi steps of one size, for spheres",
      .parameters = kDampedJacobiParameters,
      .layouts = kDampedJacobiLayouts,
      // Velocities; the metric of each contact.
      .memory =
          [](const SolverCase& c) {
            return HeldBytes{c.twist(), 3 * c.real};
          },
      // As the passes of Jacobi: the metric, two impulses, normal, bias and ids of a contact, and
      // for the bodies one twist to the contacts and two, inertia and lists at their turn.
      .traffic =
          [](const SolverCase& c) {
            const double contact = 19 * c.real + 12, body = 20 * c.real + 8;
            return Traffic{contact, body, contact + 18 * c.real, body};
          }};
}

}  // namespace scree
