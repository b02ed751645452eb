#pragma once
// Up to which gaps the same contacts are listed. Bodies are searched again with wider margins within a step; most of what was
// found then holds.

#include <cmath>

#include "kernels/types.h"

namespace scree {

/// The envelopes, from `from` on and below `to`, by which a search lists the same contacts: each that it decided about is
/// then listed, or not, as before.
struct SameList {
  double from = -INFINITY;  ///< [m]
  double to = INFINITY;     ///< [m]

  SCREE_HD bool holds(double envelope) const { return from <= envelope && envelope < to; }
  /// Decides about a contact. @param needed  the envelope that it takes [m]
  SCREE_HD bool lists(double needed, double envelope) {
    const bool is_listed = needed <= envelope;
    if (is_listed) {
      from = needed > from ? needed : from;
    } else if (!(needed > to)) {
      to = needed;
    }
    return is_listed;
  }
};

/// What a search looks at beyond its envelope, in parts of that without margins, so that its result holds for somewhat wider
/// ones. Contacts of pairs that are apart are dear to compute, and those with walls are few.
inline constexpr double kSlack = 0.25;
inline constexpr double kSolidSlack = 2;

}  // namespace scree
