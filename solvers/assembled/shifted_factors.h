#pragma once
// Factors of W, or of W' where rows are held, plus a block diagonal matrix.

#include <vector>

#include "solvers/assembled/block_factors.h"

namespace scree {

/// Ordered once, for many shifts. With held rows what is factorized is [W + shift, V; V^T, R].
class ShiftedFactors {
 public:
  /// @param p     must outlive this
  /// @param kind  Cholesky for a symmetric positive semidefinite W, whose lower blocks are not read
  explicit ShiftedFactors(const AssembledProblem& p,
                          BlockFactors::Kind kind = BlockFactors::Kind::cholesky);

  /// @param shift  symmetric blocks added to the diagonal ones [contact_count]
  /// @return       whether the sum is positive definite, or not singular, to rounding
  bool factorize(const std::vector<Block3>& shift);

  /// x = (W + shift)^-1 b, of the last sum that was factorized. b and x may be the same.
  void solve(const std::vector<double>& b, std::vector<double>& x) const;

 private:
  const AssembledProblem& p_;
  AssembledProblem whole_;  ///< with held rows behind the contacts
  BlockFactors::Kind kind_;
  BlockMatrix sum_;
  BlockFactors factors_;
};

}  // namespace scree
