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
};

}  // namespace scree
