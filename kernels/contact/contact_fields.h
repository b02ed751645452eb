#pragma once
// The fields of a contact, each listed once: as collision detection leaves them, and as the contact
// problem of a step has them. What allocates, copies, reorders, stores, checks or counts contacts
// visits these lists, so a field is known everywhere by its line here.

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

/// Rolling and spinning resistance of one contact. Moment impulses are stored divided by `length`,
/// so all rows have the unit N s and all contact velocities the unit m/s.
template <class Real>
struct RollingRow {
  Real length = 1;    ///< scale of the moment rows [m]
  Real rolling = 0;   ///< |m_t| <= rolling (gamma_n + c h) [-]
  Real spinning = 0;  ///< |m_n| <= spinning (gamma_n + c h) [-]

  template <class Other>
  explicit operator RollingRow<Other>() const {
    return {static_cast<Other>(length), static_cast<Other>(rolling), static_cast<Other>(spinning)};
  }
};

/// What of a contact is stored. The first part every contact has; of the others a problem has what
/// its layout and its materials ask for.
struct ContactParts {
  bool pair = true;       ///< bodies, normal and, as detection leaves them, key and gap
  bool bias = false;      ///< else worked out of the gap
  bool friction = false;  ///< else the same for all
  bool adhesion = false;  ///< else the same for all
  bool arms = false;
  bool rolling = false;
  bool drift = false;

  ContactParts() = default;
  /// What a layout asks for.
  constexpr explicit ContactParts(ContactLayout layout)
      : arms(layout != ContactLayout::radial),
        rolling(layout == ContactLayout::rolling || layout == ContactLayout::jointed) {}
};

using ContactPart = bool ContactParts::*;

/// How many values a field has.
enum class FieldCount : std::uint8_t {
  rows,      ///< one a contact and one a joint
  contacts,  ///< one a contact
  general,   ///< one a contact that is not radial, stored from the first of them on
};

/// What the values of a field may be.
enum class FieldValues : std::uint8_t { any, unit, not_negative };

/// A field, as its list has it.
struct ContactField {
  const char* name;  ///< in files
  FieldCount count;
  ContactPart part;                       ///< stored where this part is
  FieldValues values = FieldValues::any;  ///< numbers are finite
  bool is_optional = false;               ///< files may lack it, whatever the layout

  /// Values stored for contacts of which the first `radial` ones are radial.
  constexpr std::int64_t size(const ContactParts& parts, std::int64_t contacts,
                              std::int64_t radial) const {
    if (!(parts.*part)) return 0;
    return count == FieldCount::general ? contacts - radial : contacts;
  }
};

/// A contact as collision detection leaves it.
/// @tparam Store  what holds a field: Array<T>, and for a problem Bias and Varying
template <class Store>
struct FoundFields {
  using Real = typename Store::Real;
  template <class T>
  using Array = typename Store::template Array<T>;

  Array<std::uint64_t> key;  ///< see contact_key.h
  Array<Index> body_a;       ///< storage index
  Array<Index> body_b;       ///< storage index
  Array<Vec3<Real>> normal;  ///< unit, world frame, from body A to body B
  Array<Real> gap;           ///< signed distance [m], negative is overlap
  Array<Vec3<Real>> arm_a;   ///< center of A to the contact, world frame [m]
  Array<Vec3<Real>> arm_b;   ///< center of B to the contact, world frame [m]

  /// f(field, array of the first record, array of the second, ...) for each field.
  template <class F, class... Records>
  static constexpr void visit(F&& f, Records&&... r) {
    using Parts = ContactParts;
    using enum FieldCount;
    f(ContactField{"key", contacts, &Parts::pair}, r.key...);
    f(ContactField{"body_a", contacts, &Parts::pair}, r.body_a...);
    f(ContactField{"body_b", contacts, &Parts::pair}, r.body_b...);
    f(ContactField{"normal", contacts, &Parts::pair}, r.normal...);
    f(ContactField{"gap", contacts, &Parts::pair}, r.gap...);
    f(ContactField{"arm_a", general, &Parts::arms}, r.arm_a...);
    f(ContactField{"arm_b", general, &Parts::arms}, r.arm_b...);
  }
};

/// A contact in the problem of a step, docs/theory.md. Files list the fields in this order.
/// @tparam Store  as of FoundFields
template <class Store>
struct ProblemFields {
  using Real = typename Store::Real;
  template <class T>
  using Array = typename Store::template Array<T>;

  Array<Index> body_a;        ///< owned, and less than body_b; of joints the first that moves
  Array<Index> body_b;        ///< owned, ghost or fixed
  Array<Vec3<Real>> normal;   ///< unit, from A to B; of a joint, its axis
  typename Store::Bias bias;  ///< [m/s]
  typename Store::Varying friction;  ///< mu [-]
  typename Store::Varying adhesion;  ///< c h [N s]: the cone's apex lies at gamma_n = -c h
  Array<Vec3<Real>> arm_a;           ///< center of A to the contact over the length of A
  Array<Vec3<Real>> arm_b;           ///< the same of B
  Array<RollingRow<Real>> rolling;   ///< rolling and jointed layout only
  /// What turning bodies add to the velocity of each contact by the middle of the step [m/s], world
  /// frame; empty where no body needs it.
  Array<Vec3<Real>> drift;

  /// As that of FoundFields.
  template <class F, class... Records>
  static constexpr void visit(F&& f, Records&&... r) {
    using Parts = ContactParts;
    using enum FieldCount;
    using enum FieldValues;
    f(ContactField{"body_a", rows, &Parts::pair}, r.body_a...);
    f(ContactField{"body_b", rows, &Parts::pair}, r.body_b...);
    f(ContactField{"normal", rows, &Parts::pair, unit}, r.normal...);
    f(ContactField{"bias", contacts, &Parts::bias}, r.bias...);
    f(ContactField{"mu", contacts, &Parts::friction, not_negative}, r.friction...);
    f(ContactField{"adhesion", contacts, &Parts::adhesion, not_negative}, r.adhesion...);
    f(ContactField{"arm_a", general, &Parts::arms}, r.arm_a...);
    f(ContactField{"arm_b", general, &Parts::arms}, r.arm_b...);
    f(ContactField{"rolling", contacts, &Parts::rolling}, r.rolling...);
    f(ContactField{"drift", general, &Parts::drift, any, true}, r.drift...);
  }
};

/// Store: arrays to read, of contacts as detection leaves them.
template <class Real_>
struct InViews {
  using Real = Real_;
  template <class T>
  using Array = Span<const T>;
};

/// Store: arrays to write.
template <class Real_>
struct InSpans {
  using Real = Real_;
  template <class T>
  using Array = Span<T>;
  using Bias = Span<Real>;
  using Varying = Span<Real>;
};

/// Store: one value of each field.
template <class Real_>
struct InValues {
  using Real = Real_;
  template <class T>
  using Array = T;
  using Bias = Real;
  using Varying = Real;
};

/// For visit(): one contact of a record to a place of another one, as far as that stores the fields.
/// Fields that a radial contact lacks become zero.
struct CopyContact {
  Index from;
  Offset to;
  Index radial_count = 0;  ///< contacts of the first record that lack general fields

  template <class Values, class T>
  SCREE_HD void operator()(const ContactField& field, const Values& values,
                           const Span<T>& copy) const {
    if (copy.empty()) return;
    const Index at = field.count == FieldCount::general ? from - radial_count : from;
    copy[to] = at < 0 ? T{} : values[at];
  }
};

/// Bytes that a contact that is not radial takes. @tparam Fields  FoundFields or ProblemFields
template <template <class> class Fields, class Real>
constexpr int bytes_per_contact(const ContactParts& parts) {
  int bytes = 0;
  const Fields<InValues<Real>> one{};
  Fields<InValues<Real>>::visit(
      [&](const ContactField& field, const auto& value) {
        if (parts.*field.part) bytes += static_cast<int>(sizeof(value));
      },
      one);
  return bytes;
}

/// Whether the list of a record names all its members: spans are all of one size.
template <template <class> class Fields>
constexpr bool lists_all_members() {
  std::size_t listed = 0;
  Fields<InSpans<float>>::visit(
      [&](const ContactField&, const auto& span) { listed += sizeof(span); },
      Fields<InSpans<float>>{});
  return listed == sizeof(Fields<InSpans<float>>);
}
static_assert(lists_all_members<FoundFields>() && lists_all_members<ProblemFields>());

}  // namespace scree
