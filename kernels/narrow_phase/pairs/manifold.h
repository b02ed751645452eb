#pragma once
// All contacts of two shapes that touch in more than one point.

#include "kernels/narrow_phase/pairs/contact_geometry.h"

namespace scree {

/// Up to four contacts of a pair of shapes, features ascending.
struct Manifold {
  static constexpr int kMaxContacts = 4;
  int count = 0;
  std::uint32_t feature[kMaxContacts] = {};  ///< what touches what; the same from step to step
  ContactGeometry contact[kMaxContacts];

  SCREE_HD void drop_last() { --count; }
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

}  // namespace scree
