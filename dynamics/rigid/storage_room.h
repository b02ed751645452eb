#pragma once
// How much storage is taken where it has to grow.

#include <algorithm>
#include <limits>

#include "dynamics/model_errors.h"
#include "kernels/types.h"

namespace scree {

/// Places before those of fixed bodies, or of their parts, that are taken where so many are needed: some more, so that growth
/// is rare. @throws RunError when storage cannot be numbered
inline Index grown_room(Offset needed, Index fixed) {
  constexpr Offset kSpareShare = 16, kSpare = 64;  // one in so many, and some
  const Offset most = std::numeric_limits<Index>::max() - fixed;
  if (needed > most) throw_no_room_for_bodies(needed, most);
  return static_cast<Index>(std::min(most, needed + needed / kSpareShare + kSpare));
}

}  // namespace scree
