#pragma once
// Lists of the elements that carry a flag.

#include "kernels/types.h"

namespace scree {

/// list[before[i]] = i for those with a flag.
struct ListFlagged {
  static constexpr const char* name = "list_flagged";
  Span<const Index> flag;
  Span<const Offset> before;  ///< running sum of the flags
  Span<Index> list;

  SCREE_HD void operator()(Index i) const {
    if (flag[i] != 0) list[before[i]] = i;
  }
};

/// A list whose length the host does not know: programs run for as many elements as there may be.
struct FlaggedList {
  Span<const Index> element;
  const Offset* count = nullptr;  ///< null: none

  SCREE_HD bool has(Index n) const { return count != nullptr && n < *count; }
};

/// Two of them, one behind the other.
struct FlaggedLists {
  FlaggedList first, second;

  /// @return -1: there are not so many
  SCREE_HD Index find(Index n) const {
    if (first.has(n)) return first.element[n];
    const auto rest = static_cast<Index>(n - *first.count);
    return second.has(rest) ? second.element[rest] : -1;
  }
};

}  // namespace scree
