#pragma once
// A symmetric positive definite system of 12x12 blocks solved directly, on the host.

#include <memory>

#include "kernels/affine/block_system.h"

namespace scree::affine {

/// Block Cholesky factors L L^T by columns, in an order of the rows that keeps L sparse. The order and the places of its blocks
/// are kept while mixed blocks are at the same places. Sums have one order, whatever the number of threads.
/// Source: Davis, Direct Methods for Sparse Linear Systems, chapters 4 and 7.
class BlockFactor {
 public:
  BlockFactor();
  ~BlockFactor();
  BlockFactor(BlockFactor&&) noexcept;
  BlockFactor& operator=(BlockFactor&&) noexcept;

  struct Report {
    bool is_solved = false;  ///< false: no shift makes it definite, or a number is not finite
    double shift = 0;        ///< added to the diagonal, in parts of its largest entry
    double residual = 0;     ///< of the system as it is: |right - H x| / |right|
  };
  /// @param step  out, by row
  Report solve(const BlockSystemView& system, Span<AffineVec> step);

  /// Blocks of L below the diagonal.
  Offset fill() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace scree::affine
