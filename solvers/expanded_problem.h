#pragma once
// A problem of the mixed layout as one of the general layout.

#include "kernels/contact/expand_mixed.h"
#include "kernels/contact/field_buffers.h"
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
        contacts_(b),
        inertia_(b),
        impulse_(b, mixed.contact_count),
        lists_(b) {
    ContactProblem<Real>& p = problem_;
    p.layout = ContactLayout::general;
    p.radial_count = 0;
    p.mark = {};
    p.later[0] = {};
    ContactParts parts = parts_of(mixed);
    parts.arms = true;
    contacts_.resize_discard(parts, mixed.contact_count);
    for_each(b, mixed.contact_count, ExpandContacts<Real>{mixed, contacts_.spans()});
    point_to(p, contacts_);
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
  ProblemContacts<B, Real> contacts_;
  Buffer<B, GeneralInertia<Real>> inertia_;
  Buffer<B, Vec3<Real>> impulse_;
  BodyContacts<B> lists_;
};

}  // namespace scree
