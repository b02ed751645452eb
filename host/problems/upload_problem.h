#pragma once
// A stored contact problem in backend memory, ready for a solver. Internal to host/.

#include <algorithm>

#include "host/problems/body_problem.h"
#include "kernels/contact/field_buffers.h"
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
      : contacts_(b),
        free_velocity_(b),
        radial_(b),
        general_(b),
        mark_(b, p.contact_count()),
        guess_(b),
        lists_(b) {
    problem_.layout = p.layout;
    problem_.contact_count = p.contact_count();
    problem_.bodies = {p.free_count, p.free_count, p.free_count, p.body_count()};
    p.visit(
        [&]<class T>(const ContactField&, const auto& values, Buffer<B, T>& array, auto& field) {
          if (!is_zero_for_all(values, field))
            point_to(field, put(b, array, values, [](const auto& v) { return static_cast<T>(v); }));
        },
        p, contacts_, problem_);
    set_bodies(b, p);
    put(b, guess_, p.impulse, [](const Vec3d& v) { return Vec3<Real>(v); });
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

  /// Then a value that may be the same for all contacts takes no memory.
  template <class T, class Field>
  static bool is_zero_for_all(const std::vector<T>& values, const Field&) {
    if constexpr (std::is_same_v<Field, PerContact<Real>>) {
      return std::none_of(values.begin(), values.end(), [](double x) { return x > 0; });
    } else {
      return false;
    }
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
  ProblemContacts<B, Real> contacts_;
  Buffer<B, Twist<Real>> free_velocity_;
  Buffer<B, RadialInertia<Real>> radial_;
  Buffer<B, GeneralInertia<Real>> general_;
  Buffer<B, Index> mark_;
  Buffer<B, Vec3<Real>> guess_;
  BodyContacts<B> lists_;
};

}  // namespace scree
