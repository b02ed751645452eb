#include "dynamics/rigid/sparse_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace scree {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Added to the diagonal, in parts of it: a row that others make superfluous has a pivot of about this.
constexpr double kShift = 1e-9;
/// Pivots below this part of the diagonal are those of superfluous rows.
constexpr double kLeastPivot = 1e-7;
/// Larger pivots below this part may be, too: that of a row that has a small part in the unknowns that change together holds the
/// shift of all of them. Impulses of thin bars are such unknowns.
constexpr double kSuspect = 1e-2;
/// Multiplications of a factorization that is worth its time: about a tenth of a second.
constexpr double kMostWork = 1e8;
/// The same of free_directions(): about a hundredth of a second.
constexpr double kMostFreeWork = 1e7;
/// Square of what a direction may change, in parts of what its unknowns do one by one: floats that depend on each other do by 4e-15.
constexpr double kMostEffect = 1e-12;
/// Part of the largest entry of a direction below which one is of rounding.
constexpr double kLeastPart = 1e-12;

class Factor : public Eigen::SimplicialLDLT<Matrix> {
 public:
  /// For each row the first one, and the next one after it, that are eliminated right before it; -1: none. After analyzePattern().
  struct Tree {
    std::vector<Eigen::Index> first, next;
  };
  Tree tree() const {
    const auto size = static_cast<std::size_t>(m_parent.size());
    Tree t{std::vector<Eigen::Index>(size, -1), std::vector<Eigen::Index>(size, -1)};
    for (std::size_t k = 0; k < size; ++k) {
      const auto parent = static_cast<Eigen::Index>(m_parent[static_cast<Eigen::Index>(k)]);
      if (parent < 0) continue;
      Eigen::Index& first = t.first[static_cast<std::size_t>(parent)];
      t.next[k] = first;
      first = static_cast<Eigen::Index>(k);
    }
    return t;
  }
  /// Multiplications that factorize() takes, after analyzePattern().
  double work() const {
    double sum = 0;
    for (Eigen::Index k = 0; k < m_nonZerosPerCol.size(); ++k)
      sum += static_cast<double>(m_nonZerosPerCol[k]) * m_nonZerosPerCol[k];
    return sum;
  }
};

bool same_pattern(const Matrix& a, const Matrix& b) {
  return a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.cols(), b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

}  // namespace

struct SparseFactor::Impl {
  Matrix matrix;
  Factor factor;
  Factor::Tree tree;
  Eigen::VectorXd diagonal;       ///< in the order of elimination, as all that follows
  Eigen::VectorXd inverse_pivot;  ///< zero: the row is left out
  Eigen::VectorXd direction;      ///< z, zero where nothing was reached
  std::vector<Eigen::Index> reached;
  bool is_worth_it = false;

  /// The direction L^T z = e_k along which the pivot of row k is all that there is. @return  multiplications
  std::size_t find_direction(Eigen::Index k);
  /// What its unknowns do one by one.
  double alone() const;
  void find_superfluous();
};

std::size_t SparseFactor::Impl::find_direction(Eigen::Index k) {
  const auto& lower = factor.matrixL().nestedExpression();
  for (const Eigen::Index i : reached) direction[i] = 0;
  reached.assign(1, k);
  direction[k] = 1;
  std::size_t work = 1;
  for (std::size_t at = 0; at < reached.size(); ++at)  // what is nearer to the root comes first
    for (Eigen::Index i = tree.first[static_cast<std::size_t>(reached[at])]; i >= 0;
         i = tree.next[static_cast<std::size_t>(i)]) {
      double sum = 0;
      for (Factor::CholMatrixType::InnerIterator e(lower, i); e; ++e, ++work)
        if (e.row() > i) sum -= e.value() * direction[e.row()];
      direction[i] = sum;
      reached.push_back(i);
    }
  return work;
}

double SparseFactor::Impl::alone() const {
  double sum = 0;
  for (const Eigen::Index i : reached) sum += diagonal[i] * direction[i] * direction[i];
  return sum;
}

/// Rows whose pivots are no more than the shift of what changes with them are left out. The smallest pivots are looked at first, in
/// about the time of the factorization.
void SparseFactor::Impl::find_superfluous() {
  const Eigen::VectorXd& pivot = factor.vectorD();
  std::vector<std::pair<double, Eigen::Index>> suspects;
  for (Eigen::Index k = 0; k < pivot.size(); ++k) {
    const double part = pivot[k] / diagonal[k];
    inverse_pivot[k] = part > kLeastPivot ? 1 / pivot[k] : 0;
    if (part > kLeastPivot && part < kSuspect) suspects.emplace_back(part, k);
  }
  std::sort(suspects.begin(), suspects.end());
  double left = factor.work() + static_cast<double>(pivot.size());
  for (const auto& [part, k] : suspects) {
    if (left < 0) break;
    left -= static_cast<double>(find_direction(k));
    if (pivot[k] <= (kShift + kMostEffect) * alone()) inverse_pivot[k] = 0;
  }
}

SparseFactor::SparseFactor() : impl_(std::make_unique<Impl>()) {}
SparseFactor::~SparseFactor() = default;
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;

double SparseFactor::work(int size, const std::vector<FactorEntry>& entries) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(entries.size());
  for (const FactorEntry& e : entries) triplets.emplace_back(e.row, e.column, 1.0);
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  Factor factor;
  factor.analyzePattern(matrix);
  return factor.work();
}

bool SparseFactor::factorize(int size, const std::vector<FactorEntry>& entries) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(entries.size());
  for (const FactorEntry& e : entries)
    triplets.emplace_back(e.row, e.column, e.row == e.column ? (1 + kShift) * e.value : e.value);
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  const bool is_known = same_pattern(matrix, impl_->matrix);
  impl_->matrix.swap(matrix);
  if (!is_known) {
    impl_->factor.analyzePattern(impl_->matrix);
    impl_->tree = impl_->factor.tree();
    impl_->direction.setZero(size);
    impl_->reached.clear();
    impl_->is_worth_it = impl_->factor.work() < kMostWork;
  }
  if (!impl_->is_worth_it) return false;
  impl_->factor.factorize(impl_->matrix);
  if (impl_->factor.info() != Eigen::Success) return false;
  impl_->diagonal = impl_->factor.permutationP() * impl_->matrix.diagonal();
  impl_->inverse_pivot.resize(impl_->diagonal.size());
  impl_->find_superfluous();
  return impl_->inverse_pivot.allFinite();
}

void SparseFactor::solve(std::vector<double>& x) const {
  const auto size = static_cast<Eigen::Index>(x.size());
  Eigen::Map<Eigen::VectorXd> values(x.data(), size);
  Eigen::VectorXd y = impl_->factor.permutationP() * values;
  impl_->factor.matrixL().solveInPlace(y);
  y.array() *= impl_->inverse_pivot.array();
  impl_->factor.matrixU().solveInPlace(y);
  values = impl_->factor.permutationPinv() * y;
}

std::vector<FactorEntry> SparseFactor::free_directions() const {
  // N z = L D L^T z is zero where L^T z has entries in rows without a pivot alone.
  const Eigen::VectorXd& pivot = impl_->inverse_pivot;
  const auto superfluous = static_cast<double>((pivot.array() == 0).count());
  std::vector<FactorEntry> entries;
  if (superfluous == 0) return entries;
  const auto size = static_cast<double>(pivot.size());
  const auto terms = static_cast<double>(impl_->factor.matrixL().nestedExpression().nonZeros());
  if (superfluous * (terms + size) > kMostFreeWork) return entries;
  int direction = 0;
  for (Eigen::Index k = 0; k < pivot.size(); ++k) {
    if (pivot[k] != 0) continue;
    impl_->find_direction(k);
    // z.(N + s D) z is the pivot: rows that are but nearly superfluous have an effect.
    if (impl_->factor.vectorD()[k] > (kShift + kMostEffect) * impl_->alone()) continue;
    const Eigen::VectorXd z = impl_->factor.permutationPinv() * impl_->direction;
    const double least = kLeastPart * z.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < z.size(); ++i)
      if (std::abs(z[i]) > least) entries.push_back({static_cast<int>(i), direction, z[i]});
    ++direction;
  }
  return entries;
}

}  // namespace scree
