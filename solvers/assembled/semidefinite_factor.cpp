#include "solvers/assembled/semidefinite_factor.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace scree {
namespace {

/// What rounding leaves of a pivot that is zero, in parts of the diagonal. Where numbers were
/// rounded to float, dependent rows have pivots about the square of that, 1e-14.
constexpr double zero_pivot = 1e-12;

/// @return the row at each place of an order of least degree
std::vector<int> order_of(const SymmetricRows& a) {
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(a.column.size());
  for (int row = 0; row < a.size(); ++row)
    for (int k = a.row_start[row]; k < a.row_start[row + 1]; ++k)
      entries.emplace_back(row, a.column[k], 1);
  Matrix pattern(a.size(), a.size());
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::AMDOrdering<int> ordering;
  Eigen::AMDOrdering<int>::PermutationType order;
  ordering(pattern, order);
  std::vector<int> place(order.indices().data(), order.indices().data() + order.size());
  return place;
}

}  // namespace

SemidefiniteFactor::SemidefiniteFactor(const SymmetricRows& a) : place_(order_of(a)) {
  const int n = a.size();
  std::vector<int> number(n), parent(n, -1), count(n, 0), seen(n, -1);
  for (int k = 0; k < n; ++k) number[place_[k]] = k;
  // Calls f(i) for the columns of row k of L, each after those below it on its way up the tree.
  const auto walk_up = [&](int k, auto f) {
    seen[k] = k;
    for (int e = a.row_start[place_[k]]; e < a.row_start[place_[k] + 1]; ++e)
      for (int i = number[a.column[e]]; i < k && seen[i] != k; i = parent[i]) {
        seen[i] = k;
        if (parent[i] < 0) parent[i] = k;
        f(i);
      }
  };
  for (int k = 0; k < n; ++k) walk_up(k, [&](int i) { ++count[i]; });
  start_.assign(n + 1, 0);
  for (int k = 0; k < n; ++k) start_[k + 1] = start_[k] + count[k];
  row_.resize(start_[n]);
  value_.resize(start_[n]);
  inverse_pivot_.assign(n, 0);
  std::fill(count.begin(), count.end(), 0);
  std::fill(seen.begin(), seen.end(), -1);
  std::vector<double> y(n, 0);
  std::vector<int> columns;
  for (int k = 0; k < n; ++k) {
    columns.clear();
    walk_up(k, [&](int i) { columns.push_back(i); });
    // Numbers ascend along every way up the tree.
    std::sort(columns.begin(), columns.end());
    double whole = 0;
    for (int e = a.row_start[place_[k]]; e < a.row_start[place_[k] + 1]; ++e) {
      const int i = number[a.column[e]];
      if (i < k) y[i] += a.value[e];
      if (i == k) whole += a.value[e];
    }
    double pivot = whole;
    for (const int i : columns) {
      const double yi = y[i];
      y[i] = 0;
      const double l = yi * inverse_pivot_[i];
      if (inverse_pivot_[i] > 0)
        for (int e = start_[i]; e < start_[i] + count[i]; ++e) y[row_[e]] -= value_[e] * yi;
      pivot -= l * yi;
      row_[start_[i] + count[i]] = k;
      value_[start_[i] + count[i]] = l;
      ++count[i];
    }
    least_pivot_ = std::min(least_pivot_, whole > 0 ? pivot / whole : (pivot < 0 ? -1.0 : 0.0));
    if (whole > 0 && pivot > zero_pivot * whole) {
      inverse_pivot_[k] = 1 / pivot;
      kept_.push_back(place_[k]);
    }
  }
  std::sort(kept_.begin(), kept_.end());
}

void SemidefiniteFactor::solve(std::vector<double>& x) const {
  const int n = static_cast<int>(place_.size());
  std::vector<double> y(n);
  for (int k = 0; k < n; ++k) y[k] = inverse_pivot_[k] > 0 ? x[place_[k]] : 0;
  for (int i = 0; i < n; ++i)
    for (int e = start_[i]; e < start_[i + 1]; ++e) y[row_[e]] -= value_[e] * y[i];
  for (int k = 0; k < n; ++k) y[k] *= inverse_pivot_[k];
  for (int i = n - 1; i >= 0; --i)
    for (int e = start_[i]; e < start_[i + 1]; ++e) y[i] -= value_[e] * y[row_[e]];
  for (int k = 0; k < n; ++k) x[place_[k]] = y[k];
}

}  // namespace scree
