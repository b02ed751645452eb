#pragma once
// Evaluates the one residual (see Residual in solver.h) and the objective of given impulses.

#include <cmath>

#include "solvers/contact_passes.h"
#include "solvers/solver.h"

namespace scree {

template <class B, class Real>
class ResidualEvaluator {
 public:
  explicit ResidualEvaluator(B& backend) : contact_sums_(backend, 1), body_sums_(backend, 1) {}

  /// Contact part only: one pass, one host read; `objective` is gamma . (N gamma + r) then.
  /// @param velocity  V = v* + M^-1 J^T gamma
  template <class R>
  Residual evaluate(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> gamma,
                    Span<const Twist<Real>> velocity) {
    if (p.contacts_in_all() == 0) return {};
    ContactPasses<R, B, Real>::sum_residuals(b, p, gamma, velocity, contact_sums_.data());
    return from_sums(fetch(b, contact_sums_.data()), p.contacts_in_all());
  }

  /// Adds the objective: f = gamma . (N gamma + r) - 1/2 |V - v*|_M^2.
  template <class R>
  Residual evaluate_with_objective(B& b, const ContactProblem<Real>& p,
                                   Span<const Vec3<Real>> gamma, Span<const Twist<Real>> velocity) {
    if (p.contacts_in_all() == 0) return {};
    Residual r = evaluate<R>(b, p, gamma, velocity);
    r.objective -= impulse_energy<R>(b, p, velocity);
    return r;
  }

  /// With several ranks: says of the contacts here what a residual over all does not. One pass more.
  template <class R>
  void add_own(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> gamma,
               Span<const Twist<Real>> velocity, Residual& residual) {
    if (b.ranks() == nullptr) return;
    const Alone<B> alone(b);
    set_own(evaluate<R>(b, p, gamma, velocity), residual);
  }
  /// @param own  of the contacts here
  static void set_own(const Residual& own, Residual& residual) {
    residual.own_max = own.max;
    residual.own_max_contact = own.max_contact;
    residual.own_bad_contact = own.bad_contact;
  }

  /// 1/2 gamma^T N gamma = 1/2 |V - v*|_M^2 [J].
  /// @param velocity  V = v* + M^-1 J^T gamma
  template <class R>
  double impulse_energy(B& b, const ContactProblem<Real>& p, Span<const Twist<Real>> velocity) {
    ContactPasses<R, B, Real>::sum_impulse_energy(b, p, velocity, body_sums_.data());
    return fetch(b, body_sums_.data()).value[0];
  }

  static Residual from_sums(const ResidualSums& s, double contact_count) {
    Residual r;
    r.rms = std::sqrt(s.sum_squares / contact_count);
    r.exact_rms = std::sqrt(s.exact_squares / contact_count);
    r.max = std::sqrt(std::max(s.max_square, 0.0));
    r.max_contact = s.max_contact;
    r.objective = s.work;
    r.cone_violation = s.cone_violation;
    r.bad_contact = s.bad_contact;
    return r;
  }

 private:
  Buffer<B, ResidualSums> contact_sums_;
  Buffer<B, Sums<1>> body_sums_;
};

}  // namespace scree
