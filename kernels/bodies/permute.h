#pragma once
// Element programs that reorder arrays.

#include "kernels/types.h"

namespace scree {

/// to[k] = from[order[k]], in groups of `group` neighbors.
template <class T>
struct Gather {
  static constexpr const char* name = "gather";
  Span<const Index> order;
  Span<const T> from;
  Span<T> to;
  int group = 1;

  SCREE_HD void operator()(Index k) const {
    const auto source = static_cast<Offset>(order[k]);
    for (int v = 0; v < group; ++v)
      to[static_cast<Offset>(k) * group + v] = from[source * group + v];
  }
};

/// inverse[order[k]] = k.
struct InvertOrder {
  static constexpr const char* name = "invert_order";
  Span<const Index> order;
  Span<Index> inverse;
  SCREE_HD void operator()(Index k) const { inverse[order[k]] = k; }
};

}  // namespace scree
