#include "solvers/assembled/block_factors.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "solvers/assembled/dissection.h"

namespace scree {
namespace {

using Dense = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// A part of the dissection with the later nodes that it touches. Rows of a front are those of
/// its own nodes, then those of its border.
struct Front {
  std::vector<int> own;
  std::vector<int> border;
  int parent = -1;
  /// cholesky: L11 (its lower triangle) and L21 of L L^T.
  /// lu: A21, and A11^-1 A12 in `right`, beside the factors of A11.
  Dense diagonal, below, right;
  Eigen::PartialPivLU<Dense> lu;
  Dense update;  ///< Schur complement on the border, until the parent has taken it
};

Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> as_matrix(const Block3& b) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(b.data());
}

/// Rows of some nodes.
void gather(const std::vector<double>& x, const std::vector<int>& nodes, Vector& rows) {
  rows.resize(3 * static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int i = 0; i < 3; ++i) rows(3 * static_cast<Eigen::Index>(k) + i) = x[3 * nodes[k] + i];
}

void scatter(const Vector& rows, const std::vector<int>& nodes, std::vector<double>& x) {
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int i = 0; i < 3; ++i) x[3 * nodes[k] + i] = rows(3 * static_cast<Eigen::Index>(k) + i);
}

}  // namespace

struct BlockFactors::Fronts {
  std::vector<Front> fronts;  ///< children before parents
  std::vector<int> front_of;  ///< [rows]
  std::vector<int> mirror;    ///< of every block, where the one across the diagonal is
  std::vector<int> place;     ///< of the nodes of one front; of others meaningless
  Kind kind = Kind::cholesky;

  explicit Fronts(const BlockMatrix& m)
      : front_of(m.row_count()), mirror(m.column.size()), place(m.row_count()) {
    for (DissectedPart& part : dissect(m.row_start, m.column)) {
      Front front;
      front.own = std::move(part.nodes);
      front.parent = part.parent;
      for (const int i : front.own) front_of[i] = static_cast<int>(fronts.size());
      fronts.push_back(std::move(front));
    }
    set_borders(m);
    std::vector<int> next(m.row_start.begin(), m.row_start.end() - 1);
    // Rows visited in order meet the entries of every column in order.
    for (int row = 0; row < m.row_count(); ++row)
      for (int k = m.row_start[row]; k < m.row_start[row + 1]; ++k) mirror[next[m.column[k]]++] = k;
  }

  void set_borders(const BlockMatrix& m) {
    std::vector<int> seen(m.row_count(), -1);
    std::vector<std::vector<int>> inherited(fronts.size());
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
      Front& front = fronts[f];
      const auto add = [&](int j) {
        if (front_of[j] <= f || seen[j] == f) return;
        seen[j] = f;
        front.border.push_back(j);
      };
      for (const int i : front.own)
        for (int k = m.row_start[i]; k < m.row_start[i + 1]; ++k) add(m.column[k]);
      for (const int j : inherited[f]) add(j);
      std::sort(front.border.begin(), front.border.end(), [&](int a, int b) {
        return std::pair(front_of[a], a) < std::pair(front_of[b], b);
      });
      if (front.parent < 0) continue;
      std::vector<int>& to = inherited[front.parent];
      to.insert(to.end(), front.border.begin(), front.border.end());
    }
  }

  bool factorize(const BlockMatrix& m) {
    std::vector<std::vector<int>> children(fronts.size());
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f)
      if (fronts[f].parent >= 0) children[fronts[f].parent].push_back(f);
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
      Dense sum = assembled(m, f);
      for (const int child : children[f]) {
        extend(fronts[child], sum);
        fronts[child].update.resize(0, 0);
      }
      if (!eliminate(fronts[f], sum)) return false;
    }
    return true;
  }

  /// Entries of the matrix between the own nodes of a front and all of its nodes; of a symmetric
  /// matrix the lower triangle is complete.
  Dense assembled(const BlockMatrix& m, int f) {
    const Front& front = fronts[f];
    int count = 0;
    for (const int i : front.own) place[i] = 3 * count++;
    for (const int i : front.border) place[i] = 3 * count++;
    Dense sum = Dense::Zero(3 * count, 3 * count);
    for (const int i : front.own) {
      for (int k = m.row_start[i]; k < m.row_start[i + 1]; ++k) {
        const int j = m.column[k];
        if (front_of[j] < f) continue;
        if (kind == Kind::lu) {
          sum.block<3, 3>(place[i], place[j]) = as_matrix(m.block[k]);
          if (front_of[j] > f) sum.block<3, 3>(place[j], place[i]) = as_matrix(m.block[mirror[k]]);
        } else if (i <= j || front_of[j] > f) {
          const Block3& upper = m.block[i <= j ? k : mirror[k]];
          if (i <= j) {
            sum.block<3, 3>(place[j], place[i]) = as_matrix(upper).transpose();
          } else {
            sum.block<3, 3>(place[j], place[i]) = as_matrix(upper);
          }
          if (front_of[j] == f)
            sum.block<3, 3>(place[i], place[j]) =
                sum.block<3, 3>(place[j], place[i]).transpose().eval();
        }
      }
    }
    return sum;
  }

  /// Adds the update of a child, whose border lies in the front that `place` is of.
  void extend(const Front& child, Dense& sum) const {
    const auto count = static_cast<Eigen::Index>(child.border.size());
    for (Eigen::Index b = 0; b < count; ++b) {
      const int column = place[child.border[static_cast<std::size_t>(b)]];
      for (Eigen::Index a = kind == Kind::lu ? 0 : b; a < count; ++a) {
        const int row = place[child.border[static_cast<std::size_t>(a)]];
        if (kind == Kind::lu || row >= column) {
          sum.block<3, 3>(row, column) += child.update.block<3, 3>(3 * a, 3 * b);
        } else {
          sum.block<3, 3>(column, row) += child.update.block<3, 3>(3 * a, 3 * b).transpose();
        }
      }
    }
  }

  /// @return whether the own nodes have a regular block
  bool eliminate(Front& front, const Dense& sum) const {
    const auto own = 3 * static_cast<Eigen::Index>(front.own.size());
    const Eigen::Index rest = sum.rows() - own;
    // Eigen's factorizations and products take no matrix without rows.
    if (own == 0) {
      front.update = sum;
      front.diagonal.resize(0, 0), front.below.resize(rest, 0), front.right.resize(0, rest);
      return true;
    }
    if (kind == Kind::cholesky) {
      front.diagonal = sum.topLeftCorner(own, own);
      Eigen::LLT<Eigen::Ref<Dense>> factors(front.diagonal);
      if (factors.info() != Eigen::Success) return false;
      front.below.resize(0, own), front.update.resize(0, 0);
      if (rest == 0) return true;
      front.below = sum.bottomLeftCorner(rest, own);
      front.diagonal.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(
          front.below);
      front.update = sum.bottomRightCorner(rest, rest);
      front.update.selfadjointView<Eigen::Lower>().rankUpdate(front.below, -1);
      // Diagonal blocks of updates are added whole.
      for (Eigen::Index k = 0; k < rest; k += 3)
        for (Eigen::Index i = k; i < k + 3; ++i)
          for (Eigen::Index j = i + 1; j < k + 3; ++j) front.update(i, j) = front.update(j, i);
      return true;
    }
    front.lu.compute(sum.topLeftCorner(own, own));
    const auto pivots = front.lu.matrixLU().diagonal().cwiseAbs();
    if (!(pivots.minCoeff() > 0)) return false;
    front.below.resize(0, own), front.right.resize(own, 0), front.update.resize(0, 0);
    if (rest == 0) return true;
    front.below = sum.bottomLeftCorner(rest, own);
    front.right = front.lu.solve(sum.topRightCorner(own, rest));
    front.update = sum.bottomRightCorner(rest, rest);
    front.update.noalias() -= front.below * front.right;
    return front.update.allFinite();
  }

  void solve(std::vector<double>& x) const {
    Vector own, border;
    for (const Front& front : fronts) {
      if (front.own.empty()) continue;
      gather(x, front.own, own);
      if (kind == Kind::cholesky) {
        front.diagonal.triangularView<Eigen::Lower>().solveInPlace(own);
      } else {
        own = front.lu.solve(own).eval();
      }
      scatter(own, front.own, x);
      if (front.border.empty()) continue;
      gather(x, front.border, border);
      border.noalias() -= front.below * own;
      scatter(border, front.border, x);
    }
    for (auto f = fronts.rbegin(); f != fronts.rend(); ++f) {
      if (f->own.empty()) continue;
      gather(x, f->own, own);
      gather(x, f->border, border);
      if (kind == Kind::cholesky) {
        own.noalias() -= f->below.transpose() * border;
        f->diagonal.transpose().triangularView<Eigen::Upper>().solveInPlace(own);
      } else {
        own.noalias() -= f->right * border;
      }
      scatter(own, f->own, x);
    }
  }
};

BlockFactors::BlockFactors(const BlockMatrix& pattern)
    : fronts_(std::make_unique<Fronts>(pattern)) {}

BlockFactors::~BlockFactors() = default;

bool BlockFactors::factorize(const BlockMatrix& matrix, Kind kind) {
  fronts_->kind = kind;
  return fronts_->factorize(matrix);
}

void BlockFactors::solve(std::vector<double>& x) const { fronts_->solve(x); }

}  // namespace scree
