#include "solvers/assembled/assembled_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree {
namespace {

Block3 transposed(const Block3& b) {
  return {b[0], b[3], b[6], b[1], b[4], b[7], b[2], b[5], b[8]};
}

/// Where W_rc is stored, -1 when it is not.
int find_block(const AssembledProblem& p, int row, int column) {
  const auto first = p.column.begin() + p.row_start[row];
  const auto last = p.column.begin() + p.row_start[row + 1];
  const auto at = std::lower_bound(first, last, column);
  return at != last && *at == column ? static_cast<int>(at - p.column.begin()) : -1;
}

void subtract(const std::vector<double>& x, std::vector<double>& y) {
  for (std::size_t k = 0; k < y.size(); ++k) y[k] -= x[k];
}

std::vector<PlacedBlock> blocks_of(const AssembledProblem& p) {
  std::vector<PlacedBlock> blocks;
  for (int row = 0; row < p.contact_count; ++row)
    for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k)
      blocks.push_back({row, p.column[k], p.block[k]});
  return blocks;
}

}  // namespace

AssembledProblem assemble(int contact_count, std::vector<PlacedBlock> blocks, std::vector<double> q,
                          std::vector<double> mu) {
  AssembledProblem p;
  p.contact_count = contact_count;
  p.q = std::move(q);
  p.mu = std::move(mu);
  for (int c = 0; c < contact_count; ++c) blocks.push_back({c, c, Block3{}});
  std::stable_sort(blocks.begin(), blocks.end(), [](const PlacedBlock& a, const PlacedBlock& b) {
    return std::pair(a.row, a.column) < std::pair(b.row, b.column);
  });
  p.row_start.assign(contact_count + 1, 0);
  p.diagonal_at.assign(contact_count, 0);
  int last_row = -1;
  for (const PlacedBlock& b : blocks) {
    if (b.row != last_row || p.column.back() != b.column) {
      if (b.row == b.column) p.diagonal_at[b.row] = p.block_count();
      p.column.push_back(b.column);
      p.block.push_back(Block3{});
      ++p.row_start[b.row + 1];
      last_row = b.row;
    }
    for (int k = 0; k < 9; ++k) p.block.back()[k] += b.value[k];
  }
  for (int c = 0; c < contact_count; ++c) p.row_start[c + 1] += p.row_start[c];
  const std::size_t count = blocks.size();
  for (int row = 0; row < contact_count; ++row)
    for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k)
      if (find_block(p, p.column[k], row) < 0) blocks.push_back({p.column[k], row, Block3{}});
  return blocks.size() == count
             ? p
             : assemble(contact_count, std::move(blocks), std::move(p.q), std::move(p.mu));
}

void multiply(const AssembledProblem& p, const std::vector<double>& x, std::vector<double>& y) {
  y.resize(3 * static_cast<std::size_t>(p.contact_count));
  for (int c = 0; c < p.contact_count; ++c) {
    const std::array<double, 3> row = row_product(p, c, x.data());
    std::copy(row.begin(), row.end(), y.begin() + 3 * c);
  }
  if (p.held) subtract(p.held->change(x), y);
}

std::vector<double> multiply_transposed(const AssembledProblem& p, const std::vector<double>& x) {
  std::vector<double> y(x.size(), 0.0);
  for (int c = 0; c < p.contact_count; ++c)
    for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) y[3 * p.column[k] + j] += p.block[k][3 * i + j] * x[3 * c + i];
  if (p.held) subtract(p.held->change(x), y);
  return y;
}

std::vector<double> contact_velocity(const AssembledProblem& p, const std::vector<double>& r) {
  std::vector<double> u;
  multiply(p, r, u);
  for (std::size_t k = 0; k < u.size(); ++k) u[k] += p.q[k];
  return u;
}

double asymmetry(const AssembledProblem& p) {
  double largest = 0, difference = 0;
  for (int row = 0; row < p.contact_count; ++row) {
    for (int k = p.row_start[row]; k < p.row_start[row + 1]; ++k) {
      const int mirror = find_block(p, p.column[k], row);
      const Block3 other = mirror < 0 ? Block3{} : transposed(p.block[mirror]);
      for (int e = 0; e < 9; ++e) {
        largest = std::max(largest, std::abs(p.block[k][e]));
        difference = std::max(difference, std::abs(p.block[k][e] - other[e]));
      }
    }
  }
  return largest > 0 ? difference / largest : 0;
}

AssembledProblem symmetrized(const AssembledProblem& p) {
  std::vector<PlacedBlock> blocks = blocks_of(p);
  const std::size_t count = blocks.size();
  for (std::size_t k = 0; k < count; ++k) {
    for (double& value : blocks[k].value) value *= 0.5;
    blocks.push_back({blocks[k].column, blocks[k].row, transposed(blocks[k].value)});
  }
  AssembledProblem s = assemble(p.contact_count, std::move(blocks), p.q, p.mu);
  s.dimension = p.dimension;
  s.held = p.held;
  return s;
}

std::vector<double> contact_scales(const AssembledProblem& p) {
  std::vector<double> scale(p.contact_count);
  double sum = 0;
  int count = 0;
  for (int c = 0; c < p.contact_count; ++c) {
    const Block3& d = p.diagonal(c);
    scale[c] = (d[0] + d[4] + d[8]) / 3;
    if (scale[c] > 0) {
      sum += scale[c];
      ++count;
    }
  }
  for (double& s : scale)
    if (!(s > 0)) s = count > 0 ? sum / count : 1;
  return scale;
}

}  // namespace scree
