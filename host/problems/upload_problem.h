#pragma once
// A stored contact problem in backend memory, ready for a solver. Internal to host/.

#include <algorithm>

#include "host/problems/body_problem.h"
#include "kernels/backend/backend.h"
#include "solvers/body_contacts.h"

namespace scree {

/// Owns the arrays of a problem with bodies, and its guess. From a problem that a step wrote on the
/// same backend and in the same precision, the solver of that step makes the same bits; not where
/// contacts of the step were in two groups, which are stored as one.
template <class B, class Real>
class UploadedProblem {
 public:
  /// @param p  valid, see validate()
  UploadedProblem(B& b, const BodyProblem& p)
      : body_a_(b),
        body_b_(b),
        normal_(b),
        arm_a_(b),
        arm_b_(b),
        bias_(b),
        friction_(b),
        adhesion_(b),
        rolling_(b),
        drift_(b),
        free_velocity_(b),
        radial_(b),
        general_(b),
        mark_(b, p.contact_count()),
        guess_(b),
        lists_(b) {
    const auto vector = [](const Vec3d& v) { return Vec3<Real>(v); };
    const auto real = [](double x) { return static_cast<Real>(x); };
    problem_.layout = p.layout;
    problem_.contact_count = p.contact_count();
    problem_.bodies = {p.free_count, p.free_count, p.free_count, p.body_count()};
    upload(b, p.body_a, body_a_);
    upload(b, p.body_b, body_b_);
    problem_.body_a = body_a_.view();
    problem_.body_b = body_b_.view();
    problem_.normal = put(b, normal_, p.normal, vector);
    problem_.arm_a = put(b, arm_a_, p.arm_a, vector);
    problem_.arm_b = put(b, arm_b_, p.arm_b, vector);
    problem_.bias = put(b, bias_, p.bias, real);
    problem_.friction.values = put(b, friction_, p.mu, real);
    if (std::any_of(p.adhesion.begin(), p.adhesion.end(), [](double a) { return a > 0; }))
      problem_.adhesion.values = put(b, adhesion_, p.adhesion, real);
    problem_.rolling = put(b, rolling_, p.rolling, [&](const RollingRow<double>& r) {
      return RollingRow<Real>{real(r.length), real(r.rolling), real(r.spinning)};
    });
    problem_.drift = put(b, drift_, p.drift, vector);
    set_bodies(b, p);
    put(b, guess_, p.impulse, vector);
    fill(b, mark_.view(), Index(-1));
    problem_.mark = mark_.view();
    lists_.build(b, problem_);
  }

  const ContactProblem<Real>& problem() const { return problem_; }
  /// The guess; solvers leave their impulses in it.
  Span<Vec3<Real>> impulses() { return guess_.view(); }

 private:
  template <class T, class U, class F>
  static Span<const T> put(B& b, Buffer<B, T>& buffer, const std::vector<U>& values, F convert) {
    std::vector<T> converted;
    converted.reserve(values.size());
    for (const U& value : values) converted.push_back(convert(value));
    upload(b, converted, buffer);
    return buffer.view();
  }

  void set_bodies(B& b, const BodyProblem& p) {
    problem_.free_velocity = put(b, free_velocity_, p.free_velocity, [](const Twist<double>& t) {
      return Twist<Real>{Vec3<Real>(t.linear), Vec3<Real>(t.angular)};
    });
    problem_.radial_inertia = put(b, radial_, p.radial_inertia, to_real);
    constexpr Real solid = Real(2.5);  // r^2 / I over 1 / m
    if (std::all_of(p.radial_inertia.begin(), p.radial_inertia.end(), [&](const auto& r) {
          const RadialInertia<Real> body = to_real(r);
          return !(body.inv_spin < solid * body.inv_mass) &&
                 !(body.inv_spin > solid * body.inv_mass);
        }))
      problem_.radial_inertia.spin_ratio = solid;
    const auto sym = [](const Sym3<double>& m) {
      const auto real = [](double x) { return static_cast<Real>(x); };
      return Sym3<Real>{real(m.xx), real(m.yy), real(m.zz), real(m.xy), real(m.xz), real(m.yz)};
    };
    problem_.general_inertia =
        put(b, general_, p.general_inertia, [&](const GeneralInertia<double>& g) {
          return GeneralInertia<Real>{static_cast<Real>(g.mass), Vec3<Real>(g.inv_mass),
                                      sym(g.inertia), sym(g.inv_inertia)};
        });
  }

  static RadialInertia<Real> to_real(const RadialInertia<double>& r) {
    return {static_cast<Real>(r.inv_mass), static_cast<Real>(r.inv_spin)};
  }

  ContactProblem<Real> problem_;
  Buffer<B, Index> body_a_, body_b_;
  Buffer<B, Vec3<Real>> normal_, arm_a_, arm_b_;
  Buffer<B, Real> bias_, friction_, adhesion_;
  Buffer<B, RollingRow<Real>> rolling_;
  Buffer<B, Vec3<Real>> drift_;
  Buffer<B, Twist<Real>> free_velocity_;
  Buffer<B, RadialInertia<Real>> radial_;
  Buffer<B, GeneralInertia<Real>> general_;
  Buffer<B, Index> mark_;
  Buffer<B, Vec3<Real>> guess_;
  BodyContacts<B> lists_;
};

}  // namespace scree
