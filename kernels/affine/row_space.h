#pragma once
// Steps of rows whose equations hold them in part, in numbers of their own: y = Q^T x with the orthonormal columns of Q that the
// equations leave, and zeros behind. The system in y knows nothing of the equations. Were it kept in x, the forces that hold a row
// would stay in the residual, and its rounding would be all that is left of small residuals.

#include "kernels/affine/block_system.h"

namespace scree::affine {

/// Steps that equations leave to a row: orthonormal, in the first columns.
struct RowSpace {
  Dense<12> basis;
  int count = 12;

  /// No equation holds the row: y is x.
  SCREE_HD bool is_whole() const { return count == 12; }
};

/// Q^T v.
SCREE_HD inline AffineVec restricted(const RowSpace& s, const AffineVec& v) {
  if (s.is_whole()) return v;
  AffineVec y;
  for (int j = 0; j < s.count; ++j)
    for (int k = 0; k < 12; ++k) y.node[j / 3][j % 3] += s.basis(k, j) * entry_of(v, k);
  return y;
}

/// Q y.
SCREE_HD inline AffineVec expanded(const RowSpace& s, const AffineVec& y) {
  if (s.is_whole()) return y;
  AffineVec x;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < s.count; ++j) x.node[i / 3][i % 3] += s.basis(i, j) * entry_of(y, j);
  return x;
}

/// Q_a^T m Q_b.
SCREE_HD inline Dense<12> restricted(const RowSpace& a, const Dense<12>& m, const RowSpace& b) {
  if (a.is_whole() && b.is_whole()) return m;
  Dense<12> half, out;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < b.count; ++j) {
      if (b.is_whole()) half(i, j) = m(i, j);
      for (int k = 0; k < 12 && !b.is_whole(); ++k) half(i, j) += m(i, k) * b.basis(k, j);
    }
  }
  if (a.is_whole()) return half;
  for (int i = 0; i < a.count; ++i)
    for (int j = 0; j < b.count; ++j)
      for (int k = 0; k < 12; ++k) out(i, j) += a.basis(k, i) * half(k, j);
  return out;
}

/// The diagonal block and the right-hand side of a row in its own numbers. Bytes a row: 1,248 read besides its space, 1,248 written.
struct RestrictRow {
  static constexpr const char* name = "affine_restrict_row";
  Span<const RowSpace> space;
  Span<const Dense<12>> diagonal;
  Span<const AffineVec> right;
  Span<Dense<12>> diagonal_out;  ///< out
  Span<AffineVec> right_out;     ///< out

  SCREE_HD void operator()(Index row) const {
    diagonal_out[row] = restricted(space[row], diagonal[row], space[row]);
    right_out[row] = restricted(space[row], right[row]);
  }
};

/// A block above the diagonal in the numbers of its rows. Bytes a block: 1,160 read besides the spaces, 1,160 written.
struct RestrictMixed {
  static constexpr const char* name = "affine_restrict_mixed";
  Span<const RowSpace> space;
  Span<const MixedBlock> mixed;
  Span<MixedBlock> out;  ///< out

  SCREE_HD void operator()(Index k) const {
    const MixedBlock& m = mixed[k];
    out[k] = {m.row, m.column, restricted(space[m.row], m.value, space[m.column])};
  }
};

/// The step of a row back in its coordinates.
struct ExpandRow {
  static constexpr const char* name = "affine_expand_row";
  Span<const RowSpace> space;
  Span<AffineVec> step;

  SCREE_HD void operator()(Index row) const { step[row] = expanded(space[row], step[row]); }
};

}  // namespace scree::affine
