#pragma once
// Element programs that build the body-to-contact lists a gather needs.

#include "kernels/types.h"

namespace scree {

/// Start of each value's run in a sorted sequence: start[v] is the first position whose value is >=
/// v, for v in [0, value_count]. Run over positions 0..count (one more than elements); every start
/// is written once.
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

/// Sort keys for the contacts of bodies as B: the body, or `free_count` for bodies that do not
/// move.
struct BodyBKeys {
  static constexpr const char* name = "body_b_keys";
  Span<const Index> body_b;
  Index free_count;
  Span<std::uint64_t> key;
  Span<Index> contact;
  SCREE_HD void operator()(Index c) const {
    const Index b = body_b[c];
    key[c] = static_cast<std::uint64_t>(b < free_count ? b : free_count);
    contact[c] = c;
  }
};

}  // namespace scree
