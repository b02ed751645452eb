#pragma once
// The contacts of one step: all that collision detection tells the solvers.

#include "kernels/math/vec3.h"

namespace scree {

/// Which arrays contacts carry. Chosen once per run; the element programs are templates on it.
///   radial   spheres among themselves and on surfaces that do not rotate: both lever arms lie
///            along the normal, so none is stored and body rates are kept as surface speed r * w
///   general  any shapes: two stored lever arms
///   rolling  general, with three more rows: rolling and spinning friction
///   mixed    two groups: radial contacts come first, general ones after them
///   jointed  two groups: contacts of the rolling layout come first, joints after them
enum class ContactLayout : std::uint8_t { radial, general, rolling, mixed, jointed };

/// Impulse vectors (Vec3) stored per contact: force rows, then moment rows.
inline SCREE_HD int vectors_per_contact(ContactLayout layout) {
  return layout == ContactLayout::rolling || layout == ContactLayout::jointed ? 2 : 1;
}

/// Contacts sorted by key = (group, body a, element), unique. Body a is always free; body b may be
/// fixed.
template <class Real>
struct ContactView {
  Index count = 0;
  /// Contacts [0, radial_count) have no stored arms: all of the radial layout, the first ones of
  /// the mixed layout.
  Index radial_count = 0;
  Span<const std::uint64_t> key;  ///< see contact_key.h
  Span<const Index> body_a;       ///< storage index
  Span<const Index> body_b;       ///< storage index
  Span<const Vec3<Real>> normal;  ///< unit, world frame, from body A to body B
  Span<const Real> gap;           ///< signed distance [m], negative is overlap
  Span<const Vec3<Real>> arm_a;   ///< [count - radial_count] center of A to the contact, world [m]
  Span<const Vec3<Real>> arm_b;   ///< [count - radial_count] center of B to the contact, world [m]

  SCREE_HD bool is_radial(Index c) const { return c < radial_count; }
  /// Of contacts that are not radial.
  SCREE_HD const Vec3<Real>& lever_a(Index c) const { return arm_a[c - radial_count]; }
  SCREE_HD const Vec3<Real>& lever_b(Index c) const { return arm_b[c - radial_count]; }
};

}  // namespace scree
