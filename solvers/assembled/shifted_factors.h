#pragma once
// Cholesky factors of W plus a block diagonal matrix, for a symmetric positive semidefinite W.

#include <vector>

#include "solvers/assembled/block_factors.h"

namespace scree {

/// Ordered once, for many shifts.
class ShiftedFactors {
 public:
  /// @param p  must outlive this; its pattern must be symmetric, its lower blocks are not read
  explicit ShiftedFactors(const AssembledProblem& p);

  /// @param shift  symmetric blocks added to the diagonal ones [contact_count]
  /// @return       whether the sum is positive definite to rounding
  bool factorize(const std::vector<Block3>& shift);

  /// x = (W + shift)^-1 b, of the last sum that was factorized. b and x may be the same.
  void solve(const std::vector<double>& b, std::vector<double>& x) const;

 private:
  const AssembledProblem& p_;
  BlockMatrix sum_;
  BlockFactors factors_;
};

}  // namespace scree
