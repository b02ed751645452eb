#pragma once
// A problem of the mixed layout as one of the general layout.

#include "kernels/contact/expand_mixed.h"
#include "solvers/body_contacts.h"

namespace scree {

/// Owns the arrays that differ: 64 bytes and two lists a body, 60 a contact in float.
template <class B, class Real>
class ExpandedProblem {
 public:
  /// @param mixed  must outlive this
  ExpandedProblem(B& b, const ContactProblem<Real>& mixed)
      : mixed_(mixed),
        problem_(mixed),
        body_a_(b, mixed.contact_count),
        body_b_(b, mixed.contact_count),
        normal_(b, mixed.contact_count),
        arm_a_(b, mixed.contact_count),
        arm_b_(b, mixed.contact_count),
        drift_(b, mixed.drift.empty() ? 0 : mixed.contact_count),
        bias_(b, mixed.contact_count),
        friction_(b, mixed.friction.values.empty() ? 0 : mixed.contact_count),
        adhesion_(b, mixed.adhesion.values.empty() ? 0 : mixed.contact_count),
        inertia_(b),
        impulse_(b, mixed.contact_count),
        lists_(b) {
    ContactProblem<Real>& p = problem_;
    p.layout = ContactLayout::general;
    p.radial_count = 0;
    p.body_a = body_a_.view();
    p.body_b = body_b_.view();
    p.normal = normal_.view();
    p.arm_a = arm_a_.view();
    p.arm_b = arm_b_.view();
    p.drift = drift_.view();
    p.bias = ContactBias<Real>(bias_.view());
    p.friction.values = friction_.view();
    p.adhesion.values = adhesion_.view();
    p.mark = {};
    p.later[0] = {};
    for_each(b, mixed.contact_count,
             ExpandContacts<Real>{mixed, body_a_.view(), body_b_.view(), normal_.view(),
                                  arm_a_.view(), arm_b_.view(), bias_.view(), friction_.view(),
                                  adhesion_.view(), drift_.view()});
    if (mixed.general_inertia.empty()) {
      inertia_.reserve_discard(mixed.bodies.count);
      for_each(b, mixed.bodies.count,
               ExpandInertia<Real>{mixed, inertia_.view(mixed.bodies.count)});
      p.general_inertia = inertia_.view(mixed.bodies.count);
    }
    lists_.build(b, p);
  }

  const ContactProblem<Real>& problem() const { return problem_; }
  /// Impulses in the order of this problem.
  Span<Vec3<Real>> impulses() { return impulse_.view(); }
  void take_impulses(B& b, Span<const Vec3<Real>> mixed) {
    for_each(b, mixed_.contact_count, ExpandImpulses<Real>{mixed_, mixed, impulses()});
  }
  void give_impulses(B& b, Span<Vec3<Real>> mixed) {
    for_each(b, mixed_.contact_count, ExpandImpulses<Real>{mixed_, impulses(), mixed, true});
  }
  /// The contact of the mixed problem that stands at a place of this one.
  Index mixed_contact(B& b, Index place) const {
    const Index a = fetch(b, problem_.body_a.data + place);
    const Index radial_end = fetch(b, mixed_.a_start.data + a + 1);
    const Index general = fetch(b, mixed_.later[0].a_start.data + a);
    const Index before = place - general;  // while radial contacts of the body come
    return before < radial_end ? before : mixed_.radial_count + place - radial_end;
  }

 private:
  const ContactProblem<Real>& mixed_;
  ContactProblem<Real> problem_;
  Buffer<B, Index> body_a_, body_b_;
  Buffer<B, Vec3<Real>> normal_, arm_a_, arm_b_, drift_;
  Buffer<B, Real> bias_, friction_, adhesion_;
  Buffer<B, GeneralInertia<Real>> inertia_;
  Buffer<B, Vec3<Real>> impulse_;
  BodyContacts<B> lists_;
};

}  // namespace scree
