#include "solvers/assembled/shifted_factors.h"

namespace scree {

ShiftedFactors::ShiftedFactors(const AssembledProblem& p, BlockFactors::Kind kind)
    : p_(p),
      whole_(bordered(p)),
      kind_(kind),
      sum_{whole_.row_start, whole_.column, whole_.block},
      factors_(sum_) {}

bool ShiftedFactors::factorize(const std::vector<Block3>& shift) {
  for (int c = 0; c < p_.contact_count; ++c) {
    const int at = whole_.diagonal_at[c];
    for (int i = 0; i < 9; ++i) sum_.block[at][i] = whole_.block[at][i] + shift[c][i];
  }
  return factors_.factorize(sum_, kind_);
}

void ShiftedFactors::solve(const std::vector<double>& b, std::vector<double>& x) const {
  const std::size_t rows = b.size();
  x = b;
  x.resize(whole_.q.size(), 0.0);
  factors_.solve(x);
  x.resize(rows);
}

}  // namespace scree
