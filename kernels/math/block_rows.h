#pragma once
// A square matrix in 3x3 blocks by compressed block rows, and its product with a vector: the
// assembled operator W of contacts, whose rows are the normal and two tangents.

#include <array>

#include "kernels/types.h"

namespace scree {

/// A 3x3 block, row by row.
using Block3 = std::array<double, 9>;

/// View of a matrix. Columns ascend within a row.
struct BlockRows {
  Index row_count = 0;
  Span<const Index> start;        ///< [row_count + 1] where the blocks of a row begin
  Span<const Index> column;       ///< [block_count]
  Span<const Block3> block;       ///< [block_count]
  Span<const Index> diagonal_at;  ///< [row_count] where in `block` the diagonal one is

  SCREE_HD const Block3& diagonal(Index row) const { return block[diagonal_at[row]]; }
};

/// (W x)_row, three numbers. @param x  [3 row_count]
SCREE_HD inline std::array<double, 3> row_product(const BlockRows& w, Index row, const double* x) {
  double y0 = 0, y1 = 0, y2 = 0;
  for (Index k = w.start[row]; k < w.start[row + 1]; ++k) {
    const double* b = w.block[k].data();
    const double* v = x + 3 * static_cast<Offset>(w.column[k]);
    y0 += b[0] * v[0] + b[1] * v[1] + b[2] * v[2];
    y1 += b[3] * v[0] + b[4] * v[1] + b[5] * v[2];
    y2 += b[6] * v[0] + b[7] * v[1] + b[8] * v[2];
  }
  return {y0, y1, y2};
}

/// Element program over block rows: y = W x. Bytes per block: 72, its column 4, and 24 gathered.
struct BlockRowProduct {
  static constexpr const char* name = "block_row_product";
  BlockRows w;
  Span<const double> x;  ///< [3 row_count]
  Span<double> y;        ///< [3 row_count], another array
  SCREE_HD void operator()(Index row) const {
    const std::array<double, 3> value = row_product(w, row, x.data);
    for (int i = 0; i < 3; ++i) y[3 * static_cast<Offset>(row) + i] = value[i];
  }
};

}  // namespace scree
