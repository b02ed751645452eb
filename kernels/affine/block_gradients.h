#pragma once
// Conjugate gradients for the linear system of a Newton step, with the inverse of each diagonal block as preconditioner.
// Equations of one row restrict its steps to a subspace (row_space.h). Source: Saad, Iterative Methods for Sparse Linear Systems,
// algorithm 9.1.

#include "kernels/affine/assembly.h"
#include "kernels/affine/row_space.h"
#include "kernels/math/unrolled.h"

namespace scree::affine {

/// Blocks of rows.
struct BlockLists {
  Span<const MixedBlock> mixed;
  Span<const Index> entry, begin;  ///< see BlockHalves
};

/// Names of the entries of a block.
struct NameHalves {
  static constexpr const char* name = "affine_name_halves";
  EntryKeys keys;
  Span<const MixedBlock> mixed;
  Span<std::uint64_t> key;
  Span<Index> entry;

  SCREE_HD void operator()(Index k) const {
    const MixedBlock& m = mixed[k / 2];
    key[k] = k % 2 == 0 ? keys.key(m.row, m.column) : keys.key(m.column, m.row);
    entry[k] = k;
  }
};

/// A column of the inverse of a diagonal block, in the numbers of its row. A pivot that is not positive becomes a unit. Columns
/// factorize the block each for itself: a device has more threads than rows, and a thread a row would do five times as much one
/// after the other.
struct InvertRow {
  static constexpr const char* name = "affine_invert_row";
  static constexpr int kBlockThreads = kWaitingThreads;
  Span<const Dense<12>> diagonal;
  Span<const RowSpace> space;  ///< empty: rows have no equations
  Span<Dense<12>> inverse;     ///< out; zero beyond the numbers of the row

  /// All places of the matrix are known when this is compiled, so that it stays in registers.
  /// @param k  of 12 columns a row
  SCREE_HD void operator()(Index k) const {
    const Index row = k / 12;
    const int column = k % 12;
    const int n = space.empty() ? 12 : space[row].count;
    double a[12][12];  // the lower triangle; of a unit matrix beyond the numbers of the row
    unrolled<12>([&](auto i) {
      unrolled<i + 1>([&](auto j) { a[i][j] = i < n ? diagonal[row](i, j) : i == j ? 1 : 0; });
    });
    unrolled<12>([&](auto j) {  // a = L L^T, with 1 / L on its diagonal
      double pivot = a[j][j];
      unrolled<j>([&](auto m) { pivot -= a[j][m] * a[j][m]; });
      a[j][j] = pivot > 0 ? 1 / std::sqrt(pivot) : 1;
      unrolled<11 - j>([&](auto below) {
        constexpr int i = j + 1 + below;
        unrolled<j>([&](auto m) { a[i][j] -= a[i][m] * a[j][m]; });
        a[i][j] *= a[j][j];
      });
    });
    double y[12];
    unrolled<12>([&](auto i) {
      y[i] = i == column && i < n ? 1 : 0;
      unrolled<i>([&](auto m) { y[i] -= a[i][m] * y[m]; });
      y[i] *= a[i][i];
    });
    unrolled<12>([&](auto from_last) {
      constexpr int i = 11 - from_last;
      unrolled<from_last>([&](auto above) { y[i] -= a[i + 1 + above][i] * y[i + 1 + above]; });
      y[i] *= a[i][i];
    });
    unrolled<12>([&](auto i) { inverse[row](i, column) = y[i]; });
  }
};

/// What an iteration carries over.
struct GradientState {
  double along = 0;  ///< r.z
  double first = 0;  ///< that of the start
  double alpha = 0;
  double beta = 0;
  int iterations = 0;
  bool is_done = false;  ///< nothing changes any more
};

/// Adds matrix v, or that of its transpose.
SCREE_HD inline void add_product(const Dense<12>& m, bool is_turned, const AffineVec& v,
                                 AffineVec& sum) {
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      sum.node[i / 3][i % 3] += (is_turned ? m(j, i) : m(i, j)) * entry_of(v, j);
}

struct GradientVectors {
  Span<AffineVec> x, r, z, p, next_p, image;
  Span<const Dense<12>> diagonal, inverse;
  BlockLists lists;
  GradientState* state;

  /// z = M^-1 r of a row.
  SCREE_HD AffineVec precondition(Index row, const AffineVec& r_row) const {
    AffineVec z_row;
    add_product(inverse[row], false, r_row, z_row);
    return z_row;
  }
};

/// x = 0, r = right, z = M^-1 r.
struct BeginGradients {
  static constexpr const char* name = "affine_begin_gradients";
  GradientVectors v;
  Span<const AffineVec> right;

  SCREE_HD Sums<1> operator()(Index row) const {
    v.x[row] = AffineVec{}, v.p[row] = AffineVec{};
    v.r[row] = right[row];
    v.z[row] = v.precondition(row, right[row]);
    return {{dot(v.r[row], v.z[row])}};
  }
};
struct StartGradients {
  GradientState* state;
  SCREE_HD void operator()(const Sums<1>& total) const {
    GradientState s;
    s.along = s.first = total.value[0];
    s.is_done = !(s.along > 0);
    *state = s;
  }
};

/// The new direction z + beta p and its image. Bytes: 1,152 a block.
struct MultiplyRow {
  static constexpr const char* name = "affine_multiply_row";
  GradientVectors v;

  SCREE_HD AffineVec direction(Index row) const { return v.z[row] + v.state->beta * v.p[row]; }

  SCREE_HD Sums<1> operator()(Index row) const {
    if (v.state->is_done) return {};
    const AffineVec own = direction(row);
    AffineVec image;
    add_product(v.diagonal[row], false, own, image);
    for (Index k = v.lists.begin[row]; k < v.lists.begin[row + 1]; ++k) {
      const MixedBlock& m = v.lists.mixed[v.lists.entry[k] / 2];
      const bool is_turned = v.lists.entry[k] % 2 != 0;
      add_product(m.value, is_turned, direction(is_turned ? m.row : m.column), image);
    }
    v.next_p[row] = own;
    v.image[row] = image;
    return {{dot(own, image)}};
  }
};
struct FindAlpha {
  GradientState* state;
  SCREE_HD void operator()(const Sums<1>& total) const {
    if (state->is_done) return;
    state->alpha = total.value[0] > 0 ? state->along / total.value[0] : 0;
    if (!(total.value[0] > 0)) state->is_done = true;
  }
};

struct AdvanceRow {
  static constexpr const char* name = "affine_advance_row";
  GradientVectors v;

  SCREE_HD Sums<1> operator()(Index row) const {
    if (v.state->is_done) return {};
    const double alpha = v.state->alpha;
    v.p[row] = v.next_p[row];
    v.x[row] += alpha * v.next_p[row];
    const AffineVec r = v.r[row] - alpha * v.image[row];
    v.r[row] = r;
    v.z[row] = v.precondition(row, r);
    return {{dot(r, v.z[row])}};
  }
};
struct FindBeta {
  GradientState* state;
  double tolerance = 0;  ///< square of that of the residual
  SCREE_HD void operator()(const Sums<1>& total) const {
    if (state->is_done) return;
    state->beta = total.value[0] / state->along;
    state->along = total.value[0];
    ++state->iterations;
    state->is_done = !(state->along > tolerance * state->first);
  }
};

}  // namespace scree::affine
