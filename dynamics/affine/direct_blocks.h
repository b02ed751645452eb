#pragma once
// The linear system of a Newton step solved on the host, by a sparse factorization.

#include <memory>
#include <vector>

#include "kernels/affine/block_gradients.h"

namespace scree::affine {

/// Without equations by factors of 12x12 blocks (block_factor.h), else L D L^T of the system with its equations: they stand below it, with a small number on their diagonal, which refinement takes
/// out again, so that any order of elimination will do. Source: Vanderbei, SIAM J. Optim. 5(1), 1995.
class DirectBlocks {
 public:
  DirectBlocks(int rows, const std::vector<NodeEquation>& equations);
  ~DirectBlocks();

  /// @param step  out, by row. @return whether the matrix has such factors
  bool solve(const BlockSystemView& system, Span<AffineVec> step);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Steps of each row that its own equations leave to it; those of two rows are not looked at.
std::vector<RowSpace> row_spaces(int rows, const std::vector<NodeEquation>& equations);

}  // namespace scree::affine
