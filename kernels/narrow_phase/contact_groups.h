#pragma once
// Element programs that bring the keys of contacts into groups: radial ones first, then the others.

#include "kernels/contact/radial_bodies.h"
#include "kernels/narrow_phase/wall_contacts.h"

namespace scree {

/// Which contacts are general ones.
template <class Real>
struct FlagGeneral {
  static constexpr const char* name = "flag_general";
  BodyView<Real> bodies;
  WallView<Real> walls;
  ContactKeys keys;
  Span<const std::uint64_t> key;
  Span<Index> flag;  ///< out: 0 or 1

  SCREE_HD void operator()(Index c) const {
    const Index a = contact_body(key[c]);
    const std::uint32_t element = key_element(key[c]);
    const Index b = keys.is_body(element) ? keys.body(element) : wall_body(walls, keys, element);
    flag[c] = is_radial_body(bodies, a) && is_radial_body(bodies, b) ? 0 : 1;
  }
};

/// Puts the keys of radial contacts first, and marks those of the others; each in their old order.
struct GroupKeys {
  static constexpr const char* name = "group_keys";
  Span<const std::uint64_t> key;
  Span<const Index> flag;
  Span<const Offset> before;  ///< general contacts before each
  Offset radial_count;
  Span<std::uint64_t> grouped;  ///< out, ascending

  SCREE_HD void operator()(Index c) const {
    if (flag[c] != 0) {
      grouped[radial_count + before[c]] = key[c] | kGeneralGroup;
    } else {
      grouped[c - before[c]] = key[c];
    }
  }
};

}  // namespace scree
