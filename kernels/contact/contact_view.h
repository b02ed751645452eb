#pragma once
// The contacts of one step: all that collision detection tells the solvers.

#include "kernels/contact/contact_fields.h"

namespace scree {

/// Contacts sorted by key = (group, body a, element), unique. Body a is always free; body b may be
/// fixed.
template <class Real>
struct ContactView : FoundFields<InViews<Real>> {
  Index count = 0;
  /// Contacts [0, radial_count) have no stored arms: all of the radial layout, the first ones of
  /// the mixed layout.
  Index radial_count = 0;

  SCREE_HD bool is_radial(Index c) const { return c < radial_count; }
  /// Of contacts that are not radial.
  SCREE_HD const Vec3<Real>& lever_a(Index c) const { return this->arm_a[c - radial_count]; }
  SCREE_HD const Vec3<Real>& lever_b(Index c) const { return this->arm_b[c - radial_count]; }
};

}  // namespace scree
