#pragma once
// A sparse matrix as plain data, in compressed rows.

#include <cstdint>
#include <vector>

namespace scree {

/// One stored entry; entries of the same place add up.
struct MatrixEntry {
  std::int32_t row = 0;
  std::int32_t column = 0;
  double value = 0;
};

/// Compressed rows: columns ascend within a row and occur once. Zeros may be stored.
struct SparseMatrix {
  std::int32_t row_count = 0;
  std::int32_t column_count = 0;
  std::vector<std::int32_t> row_start{0};  ///< [row_count + 1]
  std::vector<std::int32_t> column;        ///< [entry_count]
  std::vector<double> value;               ///< [entry_count]

  std::int32_t entry_count() const { return static_cast<std::int32_t>(value.size()); }
  bool empty() const { return row_count == 0 || column_count == 0; }
  friend bool operator==(const SparseMatrix&, const SparseMatrix&) = default;
};

/// The matrix with these entries, at most 2^31 - 1; entries of the same place are added in the
/// order given. Rows and columns must lie within the matrix.
SparseMatrix compress(std::int32_t row_count, std::int32_t column_count,
                      const std::vector<MatrixEntry>& entries);

SparseMatrix transpose(const SparseMatrix& a);

/// A + A^T without the diagonal counted twice when only one triangle of A holds anything, else A:
/// some programs store symmetric matrices that way.
SparseMatrix with_both_triangles(const SparseMatrix& a);

/// A x. @param x  [column_count]
std::vector<double> multiply(const SparseMatrix& a, const std::vector<double>& x);

}  // namespace scree
