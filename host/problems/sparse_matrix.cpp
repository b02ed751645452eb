#include "host/problems/sparse_matrix.h"

#include <algorithm>

namespace scree {
namespace {

std::vector<MatrixEntry> entries_of(const SparseMatrix& a) {
  std::vector<MatrixEntry> entries;
  entries.reserve(a.value.size());
  for (std::int32_t row = 0; row < a.row_count; ++row) {
    for (std::int32_t k = a.row_start[row]; k < a.row_start[row + 1]; ++k)
      entries.push_back({row, a.column[k], a.value[k]});
  }
  return entries;
}

}  // namespace

SparseMatrix compress(std::int32_t row_count, std::int32_t column_count,
                      const std::vector<MatrixEntry>& entries) {
  // Counting sort by row, then each row by column; both keep the order of equal places.
  std::vector<std::size_t> start(static_cast<std::size_t>(row_count) + 1, 0);
  for (const MatrixEntry& e : entries) ++start[static_cast<std::size_t>(e.row) + 1];
  for (std::size_t row = 1; row < start.size(); ++row) start[row] += start[row - 1];
  std::vector<MatrixEntry> sorted(entries.size());
  {
    std::vector<std::size_t> next(start.begin(), start.end());
    for (const MatrixEntry& e : entries) sorted[next[static_cast<std::size_t>(e.row)]++] = e;
  }
  SparseMatrix a;
  a.row_count = row_count;
  a.column_count = column_count;
  a.row_start.reserve(start.size());
  a.column.reserve(entries.size());
  a.value.reserve(entries.size());
  for (std::size_t row = 0; row + 1 < start.size(); ++row) {
    const auto begin = sorted.begin() + static_cast<std::ptrdiff_t>(start[row]);
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(start[row + 1]);
    std::stable_sort(
        begin, end, [](const MatrixEntry& x, const MatrixEntry& y) { return x.column < y.column; });
    const auto row_begin = static_cast<std::size_t>(a.row_start.back());
    for (auto e = begin; e != end; ++e) {
      if (a.column.size() > row_begin && a.column.back() == e->column) {
        a.value.back() += e->value;
      } else {
        a.column.push_back(e->column);
        a.value.push_back(e->value);
      }
    }
    a.row_start.push_back(a.entry_count());
  }
  return a;
}

SparseMatrix transpose(const SparseMatrix& a) {
  std::vector<MatrixEntry> entries = entries_of(a);
  for (MatrixEntry& e : entries) std::swap(e.row, e.column);
  return compress(a.column_count, a.row_count, entries);
}

SparseMatrix with_both_triangles(const SparseMatrix& a) {
  if (a.row_count != a.column_count) return a;
  std::vector<MatrixEntry> entries = entries_of(a);
  const auto in_triangle = [&](bool upper) {
    return std::any_of(entries.begin(), entries.end(), [&](const MatrixEntry& e) {
      return e.row != e.column && (e.column > e.row) == upper && (e.value < 0 || e.value > 0);
    });
  };
  if (in_triangle(true) == in_triangle(false)) return a;
  const std::size_t stored = entries.size();
  for (std::size_t k = 0; k < stored; ++k) {
    const MatrixEntry e = entries[k];
    if (e.row != e.column) entries.push_back({e.column, e.row, e.value});
  }
  return compress(a.row_count, a.column_count, entries);
}

std::vector<double> multiply(const SparseMatrix& a, const std::vector<double>& x) {
  std::vector<double> y(static_cast<std::size_t>(a.row_count), 0);
  for (std::int32_t row = 0; row < a.row_count; ++row) {
    double sum = 0;
    for (std::int32_t k = a.row_start[row]; k < a.row_start[row + 1]; ++k)
      sum += a.value[k] * x[static_cast<std::size_t>(a.column[k])];
    y[static_cast<std::size_t>(row)] = sum;
  }
  return y;
}

}  // namespace scree
