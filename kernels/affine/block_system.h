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

/// Blocks of a row: two entries a block above the diagonal, sorted by row and then by the other row.
struct BlockHalves {
  Span<const Index> entry;  ///< 2 block + 1 where the row is that of its columns
  Span<const Index> begin;  ///< by row, and the end of the last
};

/// Symmetric and positive definite, but for directions that equations hold.
struct BlockSystemView {
  Span<const Dense<12>> diagonal;  ///< by row
  Span<const MixedBlock> mixed;    ///< rising by row, then column, each place once
  Span<const AffineVec> right;     ///< by row
  /// Empty: not listed. `mixed` may have zeros behind the blocks that are.
  BlockHalves halves = {};
};

/// A linear equation that steps keep along each of some directions: the sum of weights times nodes of one row or two is zero.
struct NodeEquation {
  int row[2] = {-1, -1};                                   ///< the second may be -1: the world
  double weight[2][4] = {};                                ///< of the nodes of AffineVec
  Vec3d direction[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< orthonormal
  int count = 3;                                           ///< of directions
};

}  // namespace scree::affine
