#pragma once
// Element programs that take contacts of given pairs of bodies out of a list.

#include "kernels/backend/backend.h"
#include "kernels/math/pair_key.h"

namespace scree {

/// Pairs of bodies by id, the lower one first, in ascending order.
struct IgnoredPairs {
  Span<const std::uint64_t> pair;

  SCREE_HD bool contains(Index id_a, Index id_b) const {
    const std::uint64_t wanted = id_a < id_b ? make_key(id_a, static_cast<std::uint32_t>(id_b))
                                             : make_key(id_b, static_cast<std::uint32_t>(id_a));
    Offset low = 0, high = pair.size;
    while (low < high) {
      const Offset middle = (low + high) / 2;
      if (pair[middle] < wanted) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low < pair.size && pair[low] == wanted;
  }
};

/// keep[c]: 1, or 0 where the two bodies of contact c are such a pair. Bytes per contact: 8 read, 8
/// gathered, 4 written.
struct MarkKept {
  static constexpr const char* name = "mark_kept";
  Span<const Index> body_a;
  Span<const Index> body_b;
  Span<const Index> id;
  IgnoredPairs ignored;
  Span<Index> keep;
  SCREE_HD void operator()(Index c) const {
    keep[c] = ignored.contains(id[body_a[c]], id[body_b[c]]) ? 0 : 1;
  }
};

/// kept[place[c]] = value[c] of the contacts that stay.
template <class T>
struct CloseGaps {
  static constexpr const char* name = "close_gaps";
  Span<const Index> keep;
  Span<const Offset> place;  ///< running sum of keep
  Span<const T> value;
  Span<T> kept;
  SCREE_HD void operator()(Index c) const {
    if (keep[c] != 0) kept[place[c]] = value[c];
  }
};

}  // namespace scree
