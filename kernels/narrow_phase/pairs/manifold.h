#pragma once
// All contacts of two shapes that touch in more than one point.

#include "kernels/math/room.h"
#include "kernels/narrow_phase/pairs/pair_side.h"

namespace scree {

/// Up to four contacts of a pair of shapes, features ascending.
struct Manifold {
  static constexpr int kMaxContacts = 4;
  int count = 0;
  std::uint32_t feature[kMaxContacts] = {};  ///< what touches what; the same from step to step
  Room<ContactGeometry, kMaxContacts> contact;

  /// There must be room.
  SCREE_HD void add(std::uint32_t new_feature, const ContactGeometry& g) {
    int at = count++;
    for (; at > 0 && feature[at - 1] > new_feature; --at) {
      feature[at] = feature[at - 1];
      contact[at] = contact[at - 1];
    }
    feature[at] = new_feature;
    contact[at] = g;
  }
};

/// Pair functions that search how two bodies lie before they find contacts. Detection runs the parts one after the other, each
/// for all pairs that need it, and keeps what the searches found.
template <class P>
concept InParts = requires {
  typename P::Search;
};
/// Whether the search itself is in parts, and tells which pairs take long in what follows.
template <class P>
concept Finishes = InParts<P> &&
    requires(const PairSide& side, const Vec3d& d, typename P::Search& search) {
  P::finish(side, side, d, search);
  P::pass(side, side, d, search);
  search.is_deep() || search.may_pass || search.has_facet;
};

/// All parts at once. @param most  bodies that are farther apart have none [m]
template <InParts P, class Listed>
SCREE_HD Manifold manifold_in_parts(const PairSide& a, const PairSide& b, const Vec3d& d,
                                    double most, Listed&& listed) {
  typename P::Search search = P::search(a, b, d, most, nullptr);
  if constexpr (Finishes<P>) {
    if (search.is_open()) P::finish(a, b, d, search);
    if (search.may_pass) P::pass(a, b, d, search);
  }
  Manifold m;
  P::contacts(a, b, d, search, most, listed,
              [&](std::uint32_t feature, const ContactGeometry& g) { m.add(feature, g); });
  return m;
}

}  // namespace scree
