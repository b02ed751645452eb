#pragma once
// Factors of large sparse matrices of 3x3 blocks, as those of contacts are.

#include <memory>
#include <vector>

#include "solvers/assembled/assembled_problem.h"

namespace scree {

/// A square matrix of 3x3 blocks in compressed rows; columns ascend within a row. Where W_rc is
/// stored W_cr is too, and so are all diagonal blocks.
struct BlockMatrix {
  std::vector<int> row_start;  ///< [rows + 1]
  std::vector<int> column;
  std::vector<Block3> block;

  int row_count() const { return static_cast<int>(row_start.size()) - 1; }
};

/// Multifrontal factors, ordered by nested dissection: fronts are dense, and so is nearly all of
/// the work. Where nothing can be separated there is one front, and it is a dense factorization.
/// Source: Duff and Reid, ACM Trans. Math. Softw. 9, 1983.
class BlockFactors {
 public:
  enum class Kind {
    cholesky,  ///< for symmetric positive definite matrices; only upper blocks are read
    lu         ///< for others, with pivots sought within the nodes of a part only
  };

  /// Orders. The pattern of all matrices that follow is that of this one.
  explicit BlockFactors(const BlockMatrix& pattern);
  ~BlockFactors();
  BlockFactors(const BlockFactors&) = delete;
  BlockFactors& operator=(const BlockFactors&) = delete;

  /// @return whether the matrix is positive definite, or not singular, to rounding
  bool factorize(const BlockMatrix& matrix, Kind kind);

  /// x = A^-1 b, in place, of the last matrix that was factorized. @param x  [3 rows]
  void solve(std::vector<double>& x) const;

 private:
  struct Fronts;
  std::unique_ptr<Fronts> fronts_;
};

}  // namespace scree
