#pragma once
// Element programs that build the body-to-contact lists a gather needs.

#include "kernels/backend/ordered_lists.h"

namespace scree {

/// Start of each value's run in a sorted sequence: start[v] is the first position whose value
/// is >= v, for v in [0, value_count]. Run over positions 0..count (one more than elements);
/// every start is written once.
template <class Value>
struct RunStarts {
  static constexpr const char* name = "run_starts";
  Span<const Value> sorted;  ///< [count], ascending
  Index count;
  Index value_count;  ///< larger values are ignored
  Span<Index> start;  ///< [value_count + 1] out

  SCREE_HD void operator()(Index position) const {
    const Offset from = position == 0 ? 0 : static_cast<Offset>(sorted[position - 1]) + 1;
    const Offset to = position == count ? value_count : static_cast<Offset>(sorted[position]);
    for (Offset v = from; v <= to && v <= value_count; ++v) start[v] = position;
  }
};

/// The same, run over the values: for few elements, which leave long gaps between runs.
template <class Value>
struct SearchStarts {
  static constexpr const char* name = "search_starts";
  Span<const Value> sorted;  ///< [count], ascending
  Index count;
  Span<Index> start;  ///< out
  SCREE_HD void operator()(Index v) const {
    start[v] = first_not_below(sorted, 0, count, static_cast<Value>(v));
  }
};

/// Counts the contacts of each owned body as B. Bytes per contact: 4 read; counts are
/// added to in the caches.
struct CountAsB {
  static constexpr const char* name = "count_as_b";
  Span<const Index> body_b;
  Index owned_count;
  Span<Index> count;  ///< [owned_count] in: zero; out
  SCREE_HD void operator()(Index c) const {
    const Index b = body_b[c];
    if (b < owned_count) atomic_add(&count[b], 1);
  }
};

/// Puts contacts among those of their body B, in any order. Bytes per contact: 4 read, 4 written.
struct PutAsB {
  static constexpr const char* name = "put_as_b";
  Span<const Index> body_b;
  Index owned_count;
  Span<const Offset> start;  ///< [owned_count + 1] scan of the counts
  Span<Index> count;         ///< [owned_count] out: zero
  Span<Index> contact;       ///< out
  SCREE_HD void operator()(Index c) const {
    const Index b = body_b[c];
    if (b < owned_count) contact[start[b] + atomic_add(&count[b], -1) - 1] = c;
  }
};

/// The list of a contact among those of bodies B. Bytes: 4 gathered.
struct BodyBOf {
  Span<const Index> body_b;
  SCREE_HD Index operator()(Index, Index c) const { return body_b[c]; }
};

/// Starts in the width that solvers read. Bytes per body: 8 read, 4 written.
struct NarrowStarts {
  static constexpr const char* name = "narrow_starts";
  Span<const Offset> wide;
  Span<Index> start;
  SCREE_HD void operator()(Index i) const { start[i] = static_cast<Index>(wide[i]); }
};

}  // namespace scree
