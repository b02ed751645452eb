#pragma once
// Lists of types that element programs choose from by kind.

#include "kernels/types.h"
#include "shapes/shape_kind.h"

namespace scree {

/// Shapes, as types with a member `kind`.
template <class... S>
struct ShapeTypes {
  /// Calls f(S{}) for the shape of that kind, if it is among them.
  template <class F>
  SCREE_HD static void visit(ShapeKind kind, F&& f) {
    // The comma of the fold keeps the order; at most one of them is it.
    (void)((kind == S::kind && (f(S{}), true)) || ...);
  }

  static constexpr bool has_repeats() {
    constexpr ShapeKind kinds[] = {S::kind..., kNoShape};
    for (std::size_t i = 0; i < sizeof...(S); ++i)
      for (std::size_t j = i + 1; j <= sizeof...(S); ++j)
        if (kinds[i] == kinds[j]) return true;
    return false;
  }
  static_assert(!has_repeats(), "two shapes have one number");
};

}  // namespace scree
