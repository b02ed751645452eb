#pragma once
// The linear system of a Newton step: twelve unknowns a row, 12x12 blocks where two bodies touch.

#include "kernels/affine/affine_state.h"
#include "kernels/math/dense.h"

namespace scree::affine {

/// A block above the diagonal; the one below it is its transpose.
struct MixedBlock {
  Index row = 0, column = 0;  ///< row < column
  Dense<12> value;
};

/// Symmetric and positive definite, but for directions that equations hold.
struct BlockSystemView {
  Span<const Dense<12>> diagonal;  ///< by row
  Span<const MixedBlock> mixed;    ///< rising by row, then column, each place once
  Span<const AffineVec> right;     ///< by row
};

/// A linear equation that steps keep, the same for the components x, y, z that it names: the sum of weights times
/// nodes of one row or two is zero.
struct NodeEquation {
  int row[2] = {-1, -1};     ///< the second may be -1: the world
  double weight[2][4] = {};  ///< of the nodes of AffineVec
  unsigned components = 7u;  ///< bits 1 x, 2 y, 4 z
};

}  // namespace scree::affine
