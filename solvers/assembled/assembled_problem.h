#pragma once
// Contact problems given by the assembled operator: W in 3x3 blocks, q and mu,
// in double on the host.
//
// u = W r + q, rows of a contact: normal, two tangents. Everything here has three rows a contact;
// 2-D problems get a second tangent that nothing acts on (assembled_form.h).

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "kernels/math/block_rows.h"
#include "solvers/assembled/held_rows.h"

namespace scree {

/// W in compressed block rows. Columns ascend within a row, the diagonal block is always there, and
/// so is W_cr where W_rc is.
struct AssembledProblem {
  int contact_count = 0;
  int dimension = 3;             ///< rows a contact has in the file it came from: 2 or 3
  std::vector<int> row_start;    ///< [contact_count + 1]
  std::vector<int> column;       ///< [block_count] contact
  std::vector<Block3> block;     ///< [block_count] [1/kg]
  std::vector<int> diagonal_at;  ///< [contact_count] where in `block` W_cc is
  std::vector<double> q;         ///< [3 contact_count] free contact velocity [m/s]
  std::vector<double> mu;        ///< [contact_count] friction coefficient [-]
  /// Bilateral rows, or null. Then the operator is W' = W - V R^-1 V^T, of which the blocks here
  /// are W, and q is q'. Blocks bound W' from above.
  std::shared_ptr<const HeldRows> held;

  int block_count() const { return static_cast<int>(block.size()); }
  const Block3& diagonal(int c) const { return block[diagonal_at[c]]; }
  Block3& diagonal(int c) { return block[diagonal_at[c]]; }
  /// View of W, valid while nothing is added or removed.
  BlockRows rows() const {
    const auto span = [](const auto& v) { return Span(v.data(), static_cast<Offset>(v.size())); };
    return {contact_count, span(row_start), span(column), span(block), span(diagonal_at)};
  }
};

/// One 3x3 block at a place; blocks of one place add up.
struct PlacedBlock {
  int row = 0;
  int column = 0;
  Block3 value{};
};

/// The problem with these blocks, zero blocks added on the diagonal and across it
/// where there are none.
/// @param q, mu  [3 n], [n]
AssembledProblem assemble(int contact_count, std::vector<PlacedBlock> blocks, std::vector<double> q,
                          std::vector<double> mu);

/// y = W x, or W' x. @param x, y  [3 contact_count], different arrays; y is resized
void multiply(const AssembledProblem& p, const std::vector<double>& x, std::vector<double>& y);

/// W^T x, or W'^T x. @param x  [3 contact_count]
std::vector<double> multiply_transposed(const AssembledProblem& p, const std::vector<double>& x);

/// u = W r + q [m/s].
std::vector<double> contact_velocity(const AssembledProblem& p, const std::vector<double>& r);

/// (W x)_c, three numbers, of the blocks alone.
inline std::array<double, 3> row_product(const AssembledProblem& p, int c, const double* x) {
  return row_product(p.rows(), c, x);
}

/// Largest |W - W^T| over largest |W|.
double asymmetry(const AssembledProblem& p);

/// The problem with (W + W^T) / 2 (R is symmetric), for which the convex model is a minimization.
AssembledProblem symmetrized(const AssembledProblem& p);

/// trace(W_cc) / 3 of every contact; where that is not positive, the mean of the others, or 1.
/// The scale d_c of the unit-free measure, and 1 / d_c of step lengths [contact_count] [1/kg].
std::vector<double> contact_scales(const AssembledProblem& p);

}  // namespace scree
