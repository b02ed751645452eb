#pragma once
// Cholesky factors of W plus a block diagonal matrix, for a symmetric positive semidefinite W.

#include <memory>
#include <vector>

#include "solvers/assembled/assembled_problem.h"

namespace scree {

/// Sparse with an approximate minimum degree ordering where W is sparse, dense where it is not. The
/// ordering is made once.
class ShiftedFactors {
 public:
  /// @param p  must outlive this; its upper blocks are not read
  explicit ShiftedFactors(const AssembledProblem& p);
  ~ShiftedFactors();
  ShiftedFactors(const ShiftedFactors&) = delete;
  ShiftedFactors& operator=(const ShiftedFactors&) = delete;

  /// @param shift  symmetric blocks added to the diagonal ones [contact_count]
  /// @return       whether the sum is positive definite to rounding
  bool factorize(const std::vector<Block3>& shift);

  /// x = (W + shift)^-1 b, of the last sum that was factorized. b and x may be the same.
  void solve(const std::vector<double>& b, std::vector<double>& x) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace scree
