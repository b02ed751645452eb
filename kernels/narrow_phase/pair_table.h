#pragma once
// Which shapes can be in contact: what the list of pair functions holds, for the host.

#include <vector>

#include "shapes/shape_kind.h"

namespace scree {

/// A pair function.
struct PairEntry {
  ShapeKind a;
  ShapeKind b;
  int feature_bits;  ///< that tell its contacts apart; of planes and meshes 0
};

/// All of them, in the order of the list.
const std::vector<PairEntry>& pair_table();

/// That of two shapes in either order; null: there is none.
const PairEntry* find_pair(ShapeKind a, ShapeKind b);

}  // namespace scree
