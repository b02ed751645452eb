#include "dynamics/rigid/shared_loads.h"

#include <Eigen/SparseCholesky>

namespace scree {

std::vector<double> ways_to_least(const std::vector<double>& values,
                                  const std::vector<FactorEntry>& directions) {
  using Matrix = Eigen::SparseMatrix<double>;
  if (directions.empty()) return {};
  const auto rows = static_cast<Eigen::Index>(values.size());
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(directions.size());
  for (const FactorEntry& e : directions) triplets.emplace_back(e.row, e.column, e.value);
  Matrix along(rows, directions.back().column + 1);
  along.setFromTriplets(triplets.begin(), triplets.end());
  const Matrix squares = along.transpose() * along;
  const Eigen::SimplicialLDLT<Matrix> factor(squares);
  if (factor.info() != Eigen::Success) return {};
  const Eigen::VectorXd ways =
      factor.solve(along.transpose() * Eigen::Map<const Eigen::VectorXd>(values.data(), rows));
  if (!ways.allFinite()) return {};
  return {ways.data(), ways.data() + ways.size()};
}

}  // namespace scree
