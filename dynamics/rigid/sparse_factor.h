#pragma once
// A symmetric sparse matrix that is solved directly, on the host.

#include <memory>
#include <vector>

namespace scree {

/// An entry on or below the diagonal; those of one place are added up.
struct FactorEntry {
  int row = 0, column = 0;
  double value = 0;
};

/// L D L^T of a matrix that is positive semidefinite. Rows that others make superfluous are left out: their unknown is zero.
class SparseFactor {
 public:
  SparseFactor();
  ~SparseFactor();
  SparseFactor(SparseFactor&&) noexcept;
  SparseFactor& operator=(SparseFactor&&) noexcept;

  /// Multiplications that the factors of a matrix take, whatever its values: 1e9 are about a second.
  static double work(int size, const std::vector<FactorEntry>& entries);
  /// The order of elimination of the last matrix serves the next one that has its pattern.
  /// @return  false: it would take too long, or the matrix has no such factors; there is none now
  bool factorize(int size, const std::vector<FactorEntry>& entries);
  /// @param x  right-hand side, replaced by the solution; of a matrix that factorize() has taken
  void solve(std::vector<double>& x) const;
  /// Directions along which unknowns may go without a change of what the matrix makes of them, one for each row that is
  /// superfluous to rounding.
  /// @return  entries by direction, their column; by unknown within it. None where there are too many to be worth the time
  std::vector<FactorEntry> free_directions() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace scree
