#pragma once
// Element programs that turn a problem of the mixed layout into one of the general layout, for those
// who know one group only.

#include "kernels/contact/contact_rows.h"

namespace scree {

/// Where contact c stands when all are sorted by body A: radial ones of a body come first.
template <class Real>
SCREE_HD Index place_by_body(const ContactProblem<Real>& mixed, Index c) {
  const Index a = mixed.body_a[c];
  return c < mixed.radial_count ? c + mixed.later[0].a_start[a]
                                : c - mixed.radial_count + mixed.a_start[a + 1];
}

/// The contacts of a mixed problem, sorted by body A, with the arms that radial ones do not store.
template <class Real>
struct ExpandContacts {
  static constexpr const char* name = "expand_contacts";
  ContactProblem<Real> mixed;
  ProblemFields<InSpans<Real>> to;  ///< empty: fields that no contact needs

  SCREE_HD void operator()(Index c) const {
    const Index k = place_by_body(mixed, c);
    mixed.visit(CopyContact{c, k, mixed.radial_count}, mixed, to);
    if (c >= mixed.radial_count) return;
    to.arm_a[k] = mixed.normal[c];  // over the length of the body
    to.arm_b[k] = -mixed.normal[c];
  }
};

/// General inertia of every body of a mixed problem.
template <class Real>
struct ExpandInertia {
  static constexpr const char* name = "expand_inertia";
  ContactProblem<Real> mixed;
  Span<GeneralInertia<Real>> inertia;
  SCREE_HD void operator()(Index i) const {
    inertia[i] = GeneralRows<Real, true>::inertia(mixed, i);
  }
};

/// Impulses from the order of a mixed problem to that of the expanded one, or back.
template <class Real>
struct ExpandImpulses {
  static constexpr const char* name = "expand_impulses";
  ContactProblem<Real> mixed;
  Span<const Vec3<Real>> from;
  Span<Vec3<Real>> to;
  bool back = false;
  SCREE_HD void operator()(Index c) const {
    const Index k = place_by_body(mixed, c);
    to[back ? c : k] = from[back ? k : c];
  }
};

}  // namespace scree
