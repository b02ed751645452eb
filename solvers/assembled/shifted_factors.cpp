#include "solvers/assembled/shifted_factors.h"

namespace scree {

ShiftedFactors::ShiftedFactors(const AssembledProblem& p, BlockFactors::Kind kind)
    : p_(p), kind_(kind), sum_{p.row_start, p.column, p.block}, factors_(sum_) {}

bool ShiftedFactors::factorize(const std::vector<Block3>& shift) {
  for (int c = 0; c < p_.contact_count; ++c) {
    const int at = p_.diagonal_at[c];
    for (int i = 0; i < 9; ++i) sum_.block[at][i] = p_.block[at][i] + shift[c][i];
  }
  return factors_.factorize(sum_, kind_);
}

void ShiftedFactors::solve(const std::vector<double>& b, std::vector<double>& x) const {
  x = b;
  factors_.solve(x);
}

}  // namespace scree
