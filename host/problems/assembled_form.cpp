#include "host/problems/assembled_form.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "host/error.h"
#include "host/problems/matrix_form.h"

namespace scree {
namespace {

/// A full matrix of so many rows takes 2 GB.
constexpr std::size_t most_dense_rows = 16'384;

Eigen::MatrixXd dense(const SparseMatrix& a) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(a.row_count, a.column_count);
  for (int row = 0; row < a.row_count; ++row)
    for (int k = a.row_start[row]; k < a.row_start[row + 1]; ++k) d(row, a.column[k]) += a.value[k];
  return d;
}

/// Parts of the largest entry to which R is symmetric.
constexpr double symmetric_R_to = 1e-10;

bool is_symmetric(const SparseMatrix& a) {
  const SparseMatrix mirrored = transpose(a);
  double largest = 0, difference = 0;
  for (int row = 0; row < a.row_count; ++row) {
    int j = mirrored.row_start[row];
    const int end = mirrored.row_start[row + 1];
    for (int k = a.row_start[row]; k < a.row_start[row + 1]; ++k) {
      for (; j < end && mirrored.column[j] < a.column[k]; ++j)
        difference = std::max(difference, std::abs(mirrored.value[j]));
      const bool is_pair = j < end && mirrored.column[j] == a.column[k];
      difference = std::max(difference, std::abs(a.value[k] - (is_pair ? mirrored.value[j] : 0)));
      largest = std::max(largest, std::abs(a.value[k]));
      if (is_pair) ++j;
    }
    for (; j < end; ++j) difference = std::max(difference, std::abs(mirrored.value[j]));
  }
  return difference <= symmetric_R_to * largest;
}

/// Bilateral constraints as rows beside the contacts of a problem that has all else.
void hold_rows(const LocalProblem& p, AssembledProblem& to) {
  std::vector<HeldEntry> V;
  V.reserve(p.V.value.size());
  for (int row = 0; row < p.V.row_count; ++row)
    for (int k = p.V.row_start[row]; k < p.V.row_start[row + 1]; ++k)
      V.push_back({p.dimension == 2 ? row / 2 * 3 + row % 2 : row, p.V.column[k], p.V.value[k]});
  double loads = 0;
  for (const double q : p.q) loads = std::max(loads, std::abs(q));
  const auto held = std::make_shared<HeldRows>(
      3 * to.contact_count, V, SymmetricRows{p.R.row_start, p.R.column, p.R.value}, p.s, loads);
  if (!held->is_semidefinite())
    throw InputError(
        "[W V; V^T R] is not positive semidefinite, expected V and R of bilateral constraints: "
        "H^T M^-1 G and G^T M^-1 G");
  const std::vector<double> load = held->load();
  for (std::size_t k = 0; k < load.size(); ++k) to.q[k] -= load[k];
  to.held = held;
}

/// The problem without its bilateral constraints, by full matrices.
LocalProblem eliminated(const LocalProblem& p) {
  const std::size_t largest = std::max(p.q.size(), p.s.size());
  if (largest > most_dense_rows)
    throw InputError(
        fmt::format("{} rows with bilateral constraints, which are eliminated by full matrices "
                    "with rolling friction and where R is not symmetric, expected at most {}",
                    largest, most_dense_rows));
  const Eigen::MatrixXd V = dense(p.V);
  const Eigen::FullPivLU<Eigen::MatrixXd> R(dense(p.R));
  if (!R.isInvertible())
    throw InputError("R is singular: the bilateral constraints depend on each other");
  const Eigen::MatrixXd W = dense(p.W) - V * R.solve(V.transpose());
  const Eigen::VectorXd shift =
      V * R.solve(Eigen::Map<const Eigen::VectorXd>(p.s.data(), static_cast<int>(p.s.size())));
  LocalProblem free;
  free.dimension = p.dimension;
  free.mu = p.mu;
  free.mu_r = p.mu_r;
  free.q = p.q;
  for (std::size_t k = 0; k < free.q.size(); ++k) free.q[k] -= shift(static_cast<int>(k));
  std::vector<MatrixEntry> entries;
  for (int row = 0; row < W.rows(); ++row)
    for (int column = 0; column < W.cols(); ++column)
      if (std::abs(W(row, column)) > 0) entries.push_back({row, column, W(row, column)});
  free.W = compress(static_cast<int>(W.rows()), static_cast<int>(W.cols()), entries);
  return free;
}

}  // namespace

AssembledProblem assembled_form(const LocalProblem& problem) {
  if (problem.dimension == 5)
    throw InputError("the problem has rolling friction, expected two or three rows a contact");
  const bool has_bilateral = problem.R.row_count > 0;
  if (has_bilateral && !is_symmetric(problem.R)) return assembled_form(eliminated(problem));
  const int dimension = problem.dimension;
  const int contact_count = problem.contact_count();
  std::vector<PlacedBlock> blocks;
  for (int row = 0; row < problem.W.row_count; ++row) {
    for (int k = problem.W.row_start[row]; k < problem.W.row_start[row + 1]; ++k) {
      const int column = problem.W.column[k];
      PlacedBlock b{row / dimension, column / dimension, Block3{}};
      // Rows are sorted by column: entries of one block in this row follow each other.
      if (!blocks.empty() && blocks.back().row == b.row && blocks.back().column == b.column) {
        blocks.back().value[3 * (row % dimension) + column % dimension] += problem.W.value[k];
        continue;
      }
      b.value[3 * (row % dimension) + column % dimension] = problem.W.value[k];
      blocks.push_back(b);
    }
  }
  AssembledProblem p =
      assemble(contact_count, std::move(blocks), to_three_rows(dimension, problem.q), problem.mu);
  p.dimension = dimension;
  if (dimension == 2) {
    for (int c = 0; c < contact_count; ++c) {
      Block3& d = p.diagonal(c);
      const double mean = 0.5 * (d[0] + d[4]);
      d[8] = mean > 0 ? mean : 1;
    }
  }
  if (has_bilateral) hold_rows(problem, p);
  return p;
}

AssembledProblem assembled_form(const StoredProblem& problem) {
  if (const auto* local = std::get_if<LocalProblem>(&problem.form)) return assembled_form(*local);
  if (const auto* global = std::get_if<GlobalProblem>(&problem.form))
    return assembled_form(local_form(*global));
  return assembled_form(local_form(std::get<BodyProblem>(problem.form)));
}

bool has_rolling_rows(const StoredProblem& problem) {
  if (const auto* local = std::get_if<LocalProblem>(&problem.form)) return local->dimension == 5;
  const auto* global = std::get_if<GlobalProblem>(&problem.form);
  return global != nullptr && global->dimension == 5;
}

RollingProblem rolling_form(const LocalProblem& problem) {
  if (problem.dimension != 5)
    throw InputError(
        fmt::format("the problem has {} rows a contact, expected 5", problem.dimension));
  if (!problem.V.empty()) return rolling_form(eliminated(problem));
  return {problem.contact_count(),
          problem.W.row_start,
          problem.W.column,
          problem.W.value,
          problem.q,
          problem.mu,
          problem.mu_r};
}

RollingProblem rolling_form(const StoredProblem& problem) {
  if (const auto* global = std::get_if<GlobalProblem>(&problem.form))
    return rolling_form(local_form(*global));
  return rolling_form(std::get<LocalProblem>(problem.form));
}

std::vector<double> to_three_rows(int dimension, const std::vector<double>& rows) {
  if (dimension != 2) return rows;
  std::vector<double> three;
  three.reserve(rows.size() / 2 * 3);
  for (std::size_t k = 0; k + 1 < rows.size(); k += 2)
    three.insert(three.end(), {rows[k], rows[k + 1], 0.0});
  return three;
}

std::vector<double> from_three_rows(int dimension, const std::vector<double>& rows) {
  if (dimension != 2) return rows;
  std::vector<double> two;
  two.reserve(rows.size() / 3 * 2);
  for (std::size_t k = 0; k + 2 < rows.size(); k += 3)
    two.insert(two.end(), {rows[k], rows[k + 1]});
  return two;
}

}  // namespace scree
