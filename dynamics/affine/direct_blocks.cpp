#include "dynamics/affine/direct_blocks.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <limits>

#include "dynamics/affine/block_factor.h"

namespace scree::affine {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// What stands against an equation's multiplier, in units of one over the largest entry of the system. The factorization takes
/// most equations before their unknowns: rounding of 1e-16 over this share is what it then loses of the system, and this share
/// is what an equation that is barely its own is first missed by. In between, refinement repairs both.
constexpr double kSlackOfEquations = 1e-7;
/// Refinements end where they no longer gain.
constexpr int kMostRefinements = 12;

}  // namespace

struct DirectBlocks::Impl {
  /// An entry of an equation in the column of an unknown.
  struct Entry {
    int equation;
    double value;
  };
  int unknowns = 0, equations = 0;
  BlockFactor blocks;  ///< of a system without equations
  std::vector<std::vector<Entry>> of_unknown;
  Matrix matrix;
  std::vector<int> pattern;  ///< rows and columns of the mixed blocks of the last matrix
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> factor;
  bool is_analyzed = false;

  void fill(const BlockSystemView& s) {
    const auto rows = static_cast<Index>(s.diagonal.size);
    const int n = unknowns + equations;
    double largest = 0;
    for (Index row = 0; row < rows; ++row)
      for (int i = 0; i < 12; ++i) largest = std::max(largest, s.diagonal[row](i, i));
    Offset entries = 78 * static_cast<Offset>(rows) + 144 * s.mixed.size + equations;
    for (const auto& column : of_unknown) entries += std::ssize(column);
    matrix.resize(n, n);
    matrix.resizeNonZeros(entries);
    int* outer = matrix.outerIndexPtr();
    int* inner = matrix.innerIndexPtr();
    double* value = matrix.valuePtr();
    int at = 0;
    Index block = 0;
    for (Index row = 0; row < rows; ++row) {
      Index end = block;
      while (end < s.mixed.size && s.mixed[end].row == row) ++end;
      for (int c = 0; c < 12; ++c) {
        const int column = 12 * row + c;
        outer[column] = at;
        const auto put = [&](int r, double v) { inner[at] = r, value[at] = v, ++at; };
        for (int i = c; i < 12; ++i) put(12 * row + i, s.diagonal[row](i, c));
        for (Index k = block; k < end; ++k)
          for (int i = 0; i < 12; ++i) put(12 * s.mixed[k].column + i, s.mixed[k].value(c, i));
        for (const Entry& e : of_unknown[static_cast<std::size_t>(column)])
          put(unknowns + e.equation, e.value);
      }
      block = end;
    }
    for (int e = 0; e < equations; ++e) {
      outer[unknowns + e] = at;
      inner[at] = unknowns + e, value[at] = -kSlackOfEquations / largest, ++at;
    }
    outer[n] = at;
  }

  bool has_pattern(const BlockSystemView& s) {
    std::vector<int> now;
    now.reserve(2 * static_cast<std::size_t>(s.mixed.size));
    for (Index k = 0; k < s.mixed.size; ++k) {
      now.push_back(s.mixed[k].row);
      now.push_back(s.mixed[k].column);
    }
    const bool is_same = is_analyzed && now == pattern;
    pattern = std::move(now);
    return is_same;
  }
};

DirectBlocks::DirectBlocks(int rows, const std::vector<NodeEquation>& equations)
    : impl_(std::make_unique<Impl>()) {
  impl_->unknowns = 12 * rows;
  impl_->of_unknown.resize(12 * static_cast<std::size_t>(rows));
  for (const NodeEquation& e : equations) {
    double size = 0;
    for (int side = 0; side < 2; ++side)
      for (int k = 0; k < 4 && e.row[side] >= 0; ++k) size += e.weight[side][k] * e.weight[side][k];
    for (int d = 0; d < e.count; ++d) {
      const int number = impl_->equations++;
      for (int side = 0; side < 2; ++side) {
        for (int i = 0; i < 12 && e.row[side] >= 0; ++i) {
          const double weight = e.weight[side][i / 3] * e.direction[d][i % 3];
          if (weight == 0) continue;
          impl_
              ->of_unknown[12 * static_cast<std::size_t>(e.row[side]) + static_cast<std::size_t>(i)]
              .push_back({number, weight / std::sqrt(size)});
        }
      }
    }
  }
}
DirectBlocks::~DirectBlocks() = default;

bool DirectBlocks::solve(const BlockSystemView& system, Span<AffineVec> step) {
  Impl& m = *impl_;
  if (m.equations == 0) return m.blocks.solve(system, step).is_solved;
  const int n = m.unknowns + m.equations;
  m.fill(system);
  if (!m.has_pattern(system)) m.factor.analyzePattern(m.matrix);
  m.is_analyzed = true;
  m.factor.factorize(m.matrix);
  if (m.factor.info() != Eigen::Success) return false;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < m.unknowns; ++i) right(i) = entry_of(system.right[i / 12], i % 12);
  Eigen::VectorXd x = m.factor.solve(right);
  const Eigen::VectorXd slack = m.matrix.diagonal().tail(m.equations);
  double moved = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kMostRefinements; ++k) {
    Eigen::VectorXd left = right - m.matrix.selfadjointView<Eigen::Lower>() * x;
    left.tail(m.equations) += slack.cwiseProduct(x.tail(m.equations));
    const Eigen::VectorXd change = m.factor.solve(left);
    const double now = change.head(m.unknowns).norm();
    if (!(now < 0.5 * moved)) break;
    x += change;
    moved = now;
  }
  if (!x.allFinite()) return false;
  for (int i = 0; i < m.unknowns; ++i) step[i / 12].node[i % 12 / 3][i % 3] = x(i);
  return true;
}

std::vector<RowSpace> row_spaces(int rows, const std::vector<NodeEquation>& equations) {
  std::vector<RowSpace> spaces(static_cast<std::size_t>(rows));
  std::vector<Eigen::MatrixXd> held(static_cast<std::size_t>(rows), Eigen::MatrixXd(0, 12));
  for (const NodeEquation& e : equations) {
    if (e.row[1] >= 0) continue;
    Eigen::MatrixXd& m = held[static_cast<std::size_t>(e.row[0])];
    for (int d = 0; d < e.count; ++d) {
      m.conservativeResize(m.rows() + 1, 12);
      for (int i = 0; i < 12; ++i) m(m.rows() - 1, i) = e.weight[0][i / 3] * e.direction[d][i % 3];
      m.row(m.rows() - 1).normalize();
    }
  }
  for (int row = 0; row < rows; ++row) {
    RowSpace& space = spaces[static_cast<std::size_t>(row)];
    const Eigen::MatrixXd& m = held[static_cast<std::size_t>(row)];
    Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(12, 12);
    if (m.rows() > 0) {  // the last columns of Q are at right angles to the equations
      const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(m.transpose());
      const auto rank = static_cast<int>(qr.rank());
      const Eigen::MatrixXd q = qr.householderQ();
      basis.setZero();
      basis.leftCols(12 - rank) = q.rightCols(12 - rank);
      space.count = 12 - rank;
    }
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) space.basis(i, j) = basis(i, j);
  }
  return spaces;
}

}  // namespace scree::affine
