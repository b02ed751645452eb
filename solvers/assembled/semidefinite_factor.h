#pragma once
// L D L^T of a sparse symmetric positive semidefinite matrix whose rows may depend on each other.

#include <memory>
#include <vector>

namespace scree {

/// A symmetric matrix in compressed rows, both triangles. Columns need not ascend.
struct SymmetricRows {
  std::vector<int> row_start{0};  ///< [size + 1]
  std::vector<int> column;
  std::vector<double> value;

  int size() const { return static_cast<int>(row_start.size()) - 1; }
};

/// Row by row, in an order of least degree. A row that depends on those before it has a pivot of
/// zero, to rounding: it is left out, as if the matrix did not have it. For chains and trees the
/// work and the memory grow with the number of rows. Source: up-looking factorization along the
/// elimination tree, Davis, "Direct Methods for Sparse Linear Systems", SIAM 2006, chapter 4.
class SemidefiniteFactor {
 public:
  /// @param matrix  no diagonal entry below zero but for rounding
  explicit SemidefiniteFactor(const SymmetricRows& matrix);

  /// Rows that are not left out, ascending.
  const std::vector<int>& kept() const { return kept_; }
  /// The least pivot met, in parts of its diagonal entry: about -1 where the matrix is not
  /// semidefinite, rounding below zero where it is.
  double least_pivot() const { return least_pivot_; }

  /// x of the rows that are kept, zero in the others, so that rows kept fit b.
  /// @param x  [size] in: b, whose values in rows left out are not read; out: x
  void solve(std::vector<double>& x) const;

 private:
  std::vector<int> place_;  ///< row of the matrix at each place in the order
  std::vector<int> start_;  ///< [size + 1] of the columns of L
  std::vector<int> row_;
  std::vector<double> value_;
  std::vector<double> inverse_pivot_;  ///< zero: left out
  std::vector<int> kept_;
  double least_pivot_ = 1;
};

}  // namespace scree
