#pragma once
// The contacts of one step: all that collision detection tells the solvers.

#include "kernels/math/vec3.h"

namespace scree {

/// Which arrays a contact carries. Chosen once per run; the element programs are templates on it.
///   radial   spheres among themselves and on surfaces that do not rotate: both lever arms lie
///            along the normal, so none is stored and body rates are kept as surface speed r * w
///   general  any shapes: two stored lever arms
///   rolling  general, with three more rows: rolling and spinning friction
enum class ContactLayout : std::uint8_t { radial, general, rolling };

/// Impulse vectors (Vec3) stored per contact: force rows, then moment rows.
inline SCREE_HD int vectors_per_contact(ContactLayout layout) {
  return layout == ContactLayout::rolling ? 2 : 1;
}

/// Contacts sorted by key = (body a, element), unique. Body a is always free; body b may be fixed.
template <class Real>
struct ContactView {
  Index count = 0;
  Span<const std::uint64_t> key;  ///< high half: a; low half: the body or wall feature it touches
  Span<const Index> body_a;       ///< storage index
  Span<const Index> body_b;       ///< storage index
  Span<const Vec3<Real>> normal;  ///< unit, world frame, from body A to body B
  Span<const Real> gap;           ///< signed distance [m], negative is overlap
  Span<const Vec3<Real>> arm_a;  ///< center of A to the contact point, world [m]; empty when radial
  Span<const Vec3<Real>> arm_b;  ///< center of B to the contact point, world [m]; empty when radial
};

}  // namespace scree
