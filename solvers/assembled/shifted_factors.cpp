#include "solvers/assembled/shifted_factors.h"

#define EIGEN_DONT_PARALLELIZE  // the caller decides what runs in parallel
#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

namespace scree {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Share of blocks that are stored from which the dense factorization is the faster one.
constexpr double dense_from = 0.15;

}  // namespace

struct ShiftedFactors::Factors {
  const AssembledProblem& p;
  bool is_dense;
  bool has_pattern = false;
  Eigen::LLT<Eigen::MatrixXd> dense;
  Eigen::SimplicialLLT<Sparse> sparse;

  explicit Factors(const AssembledProblem& problem)
      : p(problem),
        is_dense(problem.block_count() >=
                 dense_from * problem.contact_count * problem.contact_count) {}

  /// Calls visit(row, column, value) for the lower triangle of the sum.
  template <class F>
  void lower(const std::vector<Block3>& shift, F visit) const {
    for (int c = 0; c < p.contact_count; ++c) {
      for (int k = p.row_start[c]; k < p.row_start[c + 1] && p.column[k] <= c; ++k) {
        const bool own = p.column[k] == c;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < (own ? i + 1 : 3); ++j)
            visit(3 * c + i, 3 * p.column[k] + j,
                  p.block[k][3 * i + j] + (own ? shift[c][3 * i + j] : 0));
      }
    }
  }
};

ShiftedFactors::ShiftedFactors(const AssembledProblem& p)
    : factors_(std::make_unique<Factors>(p)) {}

ShiftedFactors::~ShiftedFactors() = default;

bool ShiftedFactors::factorize(const std::vector<Block3>& shift) {
  Factors& f = *factors_;
  const int rows = 3 * f.p.contact_count;
  if (f.is_dense) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, rows);
    f.lower(shift, [&](int i, int j, double value) { sum(i, j) = value; });
    f.dense.compute(sum);
    return f.dense.info() == Eigen::Success;
  }
  std::vector<Eigen::Triplet<double>> entries;
  f.lower(shift, [&](int i, int j, double value) { entries.emplace_back(i, j, value); });
  Sparse sum(rows, rows);
  sum.setFromTriplets(entries.begin(), entries.end());
  if (!f.has_pattern) f.sparse.analyzePattern(sum);
  f.has_pattern = true;
  f.sparse.factorize(sum);
  return f.sparse.info() == Eigen::Success;
}

void ShiftedFactors::solve(const std::vector<double>& b, std::vector<double>& x) const {
  const Eigen::Map<const Eigen::VectorXd> right(b.data(), static_cast<Eigen::Index>(b.size()));
  const Eigen::VectorXd y = factors_->is_dense ? factors_->dense.solve(right).eval()
                                               : factors_->sparse.solve(right).eval();
  x.assign(y.data(), y.data() + y.size());
}

}  // namespace scree
