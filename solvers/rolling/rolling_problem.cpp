#include "solvers/rolling/rolling_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace scree {
namespace {

RollingProblem transposed(const RollingProblem& p) {
  RollingProblem t = p;
  const int rows = 5 * p.contact_count;
  std::fill(t.row_start.begin(), t.row_start.end(), 0);
  for (const int column : p.column) ++t.row_start[column + 1];
  for (int row = 0; row < rows; ++row) t.row_start[row + 1] += t.row_start[row];
  std::vector<int> next(t.row_start.begin(), t.row_start.end() - 1);
  for (int row = 0; row < rows; ++row)
    for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k) {
      const int at = next[p.column[k]]++;
      t.column[at] = row;
      t.value[at] = p.value[k];
    }
  return t;
}

/// Calls use(row, column, W_rc, (W^T)_rc) for every place that one of them has.
template <class Use>
void for_both(const RollingProblem& p, Use use) {
  const RollingProblem t = transposed(p);
  for (int row = 0; row < 5 * p.contact_count; ++row) {
    int k = p.row_start[row], l = t.row_start[row];
    const int k_end = p.row_start[row + 1], l_end = t.row_start[row + 1];
    while (k < k_end || l < l_end) {
      const bool mine = k < k_end && (l == l_end || p.column[k] <= t.column[l]);
      const bool other = l < l_end && (k == k_end || t.column[l] <= p.column[k]);
      const int column = mine ? p.column[k] : t.column[l];
      use(row, column, mine ? p.value[k] : 0, other ? t.value[l] : 0);
      k += mine;
      l += other;
    }
  }
}

/// Row of a contact: 0 for velocities, 1 for rates.
int kind_of(int row) { return row % 5 < 3 ? 0 : 1; }

}  // namespace

double row_product(const RollingProblem& p, int row, const std::vector<double>& x) {
  double sum = 0;
  for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k) sum += p.value[k] * x[p.column[k]];
  return sum;
}

std::vector<double> multiply(const RollingProblem& p, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  for (int row = 0; row < 5 * p.contact_count; ++row) y[row] = row_product(p, row, x);
  return y;
}

std::vector<double> contact_velocity(const RollingProblem& p, const std::vector<double>& r) {
  std::vector<double> u = multiply(p, r);
  for (std::size_t k = 0; k < u.size(); ++k) u[k] += p.q[k];
  return u;
}

double asymmetry(const RollingProblem& p) {
  double largest = 0, difference = 0;
  for_both(p, [&](int, int, double a, double b) {
    largest = std::max(largest, std::abs(a));
    difference = std::max(difference, std::abs(a - b));
  });
  return largest > 0 ? difference / largest : 0;
}

RollingProblem symmetrized(const RollingProblem& p) {
  RollingProblem s = p;
  s.column.clear();
  s.value.clear();
  std::fill(s.row_start.begin(), s.row_start.end(), 0);
  for_both(p, [&](int row, int column, double a, double b) {
    s.column.push_back(column);
    s.value.push_back(0.5 * a + 0.5 * b);
    s.row_start[row + 1] = static_cast<int>(s.column.size());
  });
  for (std::size_t row = 1; row < s.row_start.size(); ++row)
    s.row_start[row] = std::max(s.row_start[row], s.row_start[row - 1]);
  return s;
}

std::vector<double> contact_scales(const RollingProblem& p) {
  std::vector<double> scale(2 * static_cast<std::size_t>(p.contact_count), 0);
  for (int row = 0; row < 5 * p.contact_count; ++row)
    for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k)
      if (p.column[k] == row) scale[2 * (row / 5) + kind_of(row)] += p.value[k];
  for (int kind = 0; kind < 2; ++kind) {
    double sum = 0;
    int count = 0;
    for (int c = 0; c < p.contact_count; ++c) {
      double& s = scale[2 * c + kind];
      s /= kind == 0 ? 3 : 2;
      if (s > 0) sum += s, ++count;
    }
    for (int c = 0; c < p.contact_count; ++c)
      if (!(scale[2 * c + kind] > 0)) scale[2 * c + kind] = count > 0 ? sum / count : 1;
  }
  return scale;
}

RollingProblem scaled(const RollingProblem& p, const std::vector<double>& scales) {
  RollingProblem s = p;
  const auto root = [&](int row) { return std::sqrt(scales[2 * (row / 5) + kind_of(row)]); };
  for (int row = 0; row < 5 * p.contact_count; ++row) {
    for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k)
      s.value[k] /= root(row) * root(p.column[k]);
    s.q[row] /= root(row);
  }
  for (int c = 0; c < p.contact_count; ++c)
    s.mu_r[c] *= std::sqrt(scales[2 * c + 1] / scales[2 * c]);
  return s;
}

}  // namespace scree
