#include "solvers/assembled/held_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/assembled/assembled_problem.h"

namespace scree {
namespace {

/// Velocity that a dependent row may be left with, in parts of the loads: numbers rounded to float
/// differ by less.
constexpr double contradiction = 1e-6;

/// Parts of the largest entry that rounding to float leaves of pivots and dependent rows.
constexpr double rounded_pivot = 1e-8, rounded_row = 1e-5;

/// b + R x. @return [size]
std::vector<double> sum_of(const SymmetricRows& R, const std::vector<double>& x,
                           std::vector<double> b) {
  for (int row = 0; row < R.size(); ++row)
    for (int k = R.row_start[row]; k < R.row_start[row + 1]; ++k)
      b[row] += R.value[k] * x[R.column[k]];
  return b;
}

double largest(const std::vector<double>& v) {
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

}  // namespace

HeldRows::HeldRows(int contact_rows, const std::vector<HeldEntry>& V, SymmetricRows R,
                   std::vector<double> s, double loads)
    : start_(contact_rows + 1, 0), held_(V.size()), value_(V.size()) {
  for (const HeldEntry& e : V) ++start_[e.row + 1];
  for (int row = 0; row < contact_rows; ++row) start_[row + 1] += start_[row];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (const HeldEntry& e : V) {
    held_[next[e.row]] = e.held;
    value_[next[e.row]++] = e.value;
  }
  auto system = std::make_shared<System>(std::move(R), std::move(s));
  system_ = system;
  // What impulses without a pattern do at the contacts, rows that are kept take back in all rows.
  std::vector<double> some(contact_rows);
  for (int row = 0; row < contact_rows; ++row) some[row] = std::sin(1.0 + 2.0 * row);
  const std::vector<double> moved = transposed(some);
  const std::vector<double> not_taken = sum_of(system->R, solved(moved, -1), moved);
  system->is_semidefinite = system->factor.least_pivot() > -rounded_pivot &&
                            largest(not_taken) <= rounded_row * largest(moved);
  // So what a row that depends on others is left with is the same whatever acts at the contacts.
  const std::vector<double> missing = sum_of(system->R, solved(system->s, -1), system->s);
  const double allowed = contradiction * std::max(loads, largest(system->s));
  double square = 0, worst = allowed;
  for (int row = 0; row < row_count(); ++row) {
    square += missing[row] * missing[row];
    if (!(std::abs(missing[row]) > worst)) continue;
    worst = std::abs(missing[row]);
    system->worst_row = row;
  }
  if (system->worst_row >= 0) system->left = std::sqrt(square);
}

std::vector<double> HeldRows::transposed(const std::vector<double>& x) const {
  std::vector<double> y(row_count(), 0.0);
  each_entry([&](int row, int held, double value) { y[held] += value * x[row]; });
  return y;
}

std::vector<double> HeldRows::times(const std::vector<double>& l) const {
  std::vector<double> y(start_.size() - 1, 0.0);
  each_entry([&](int row, int held, double value) { y[row] += value * l[held]; });
  return y;
}

std::vector<double> HeldRows::change(const std::vector<double>& x) const {
  return times(solved(transposed(x)));
}

std::vector<double> HeldRows::load() const { return times(solved(system_->s)); }

std::vector<double> HeldRows::impulses(const std::vector<double>& r) const {
  std::vector<double> moved = transposed(r);
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k] += system_->s[k];
  return solved(std::move(moved), -1);
}

std::vector<double> HeldRows::solved(std::vector<double> b, double sign) const {
  for (double& x : b) x *= sign;
  system_->factor.solve(b);
  return b;
}

std::shared_ptr<const HeldRows> HeldRows::scaled(const std::vector<double>& factor) const {
  auto copy = std::make_shared<HeldRows>(*this);
  for (std::size_t row = 0; row < factor.size(); ++row)
    for (int k = start_[row]; k < start_[row + 1]; ++k) copy->value_[k] *= factor[row];
  return copy;
}

AssembledProblem bordered(const AssembledProblem& p) {
  if (!p.held) return p;
  const HeldRows& held = *p.held;
  const std::vector<int>& kept = held.kept();
  std::vector<int> number(held.row_count(), -1);
  for (std::size_t k = 0; k < kept.size(); ++k) number[kept[k]] = static_cast<int>(k);
  const int first = p.contact_count;
  const int extra = static_cast<int>((kept.size() + 2) / 3);
  std::vector<PlacedBlock> blocks;
  for (int row = 0; row < p.contact_count; ++row)
    for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k)
      blocks.push_back({row, p.column[k], p.block[k]});
  const auto add = [&](int row, int column, double value) {
    if (blocks.empty() || blocks.back().row != row / 3 || blocks.back().column != column / 3)
      blocks.push_back({row / 3, column / 3, Block3{}});
    blocks.back().value[3 * (row % 3) + column % 3] += value;
  };
  held.each_entry([&](int row, int l, double value) {
    if (number[l] >= 0) add(row, 3 * first + number[l], value);
  });
  held.each_entry([&](int row, int l, double value) {
    if (number[l] >= 0) add(3 * first + number[l], row, value);
  });
  const SymmetricRows& R = held.R();
  for (const int row : kept)
    for (int k = R.row_start[row]; k < R.row_start[row + 1]; ++k)
      if (number[R.column[k]] >= 0)
        add(3 * first + number[row], 3 * first + number[R.column[k]], R.value[k]);
  for (int k = static_cast<int>(kept.size()); k < 3 * extra; ++k)
    add(3 * first + k, 3 * first + k, 1);
  std::vector<double> q = p.q, mu = p.mu;
  q.resize(q.size() + 3 * static_cast<std::size_t>(extra), 0.0);
  mu.resize(mu.size() + static_cast<std::size_t>(extra), 0.0);
  AssembledProblem whole = assemble(first + extra, std::move(blocks), std::move(q), std::move(mu));
  whole.dimension = p.dimension;
  return whole;
}

}  // namespace scree
