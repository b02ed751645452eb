#include "dynamics/rigid/sparse_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace scree {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Added to the diagonal, in parts of it: a row that others make superfluous has a pivot of about this.
constexpr double kShift = 1e-9;
/// Pivots below this part of the diagonal are those of superfluous rows.
constexpr double kLeastPivot = 1e-7;
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
  Eigen::VectorXd inverse_pivot;  ///< zero: the row is left out
  bool is_worth_it = false;
};

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
    impl_->is_worth_it = impl_->factor.work() < kMostWork;
  }
  if (!impl_->is_worth_it) return false;
  impl_->factor.factorize(impl_->matrix);
  if (impl_->factor.info() != Eigen::Success) return false;
  const Eigen::VectorXd diagonal = impl_->factor.permutationP() * impl_->matrix.diagonal();
  impl_->inverse_pivot = impl_->factor.vectorD();
  for (Eigen::Index k = 0; k < diagonal.size(); ++k) {
    double& pivot = impl_->inverse_pivot[k];
    pivot = pivot > kLeastPivot * diagonal[k] ? 1 / pivot : 0;
  }
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
    Eigen::VectorXd z = Eigen::VectorXd::Unit(pivot.size(), k);
    impl_->factor.matrixU().solveInPlace(z);
    // z.(N + s D) z is the pivot: rows that are but nearly superfluous have an effect.
    z = impl_->factor.permutationPinv() * z;
    const double alone = z.cwiseAbs2().dot(impl_->matrix.diagonal());
    if (impl_->factor.vectorD()[k] > (kShift + kMostEffect) * alone) continue;
    const double least = kLeastPart * z.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < z.size(); ++i)
      if (std::abs(z[i]) > least) entries.push_back({static_cast<int>(i), direction, z[i]});
    ++direction;
  }
  return entries;
}

}  // namespace scree
