#pragma once
// Dense and sparse systems by Eigen's decompositions, compiled once: each takes seconds in every source that has it.

#include <Eigen/Core>
#include <vector>

namespace scree::oracle {

/// The x of least norm among those that make |a x - b| least; of a regular a the solution.
Eigen::MatrixXd least_norm(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// Eigenvalues of a symmetric matrix, rising.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

/// The positive semidefinite matrix nearest to a symmetric one.
Eigen::MatrixXd semidefinite(const Eigen::MatrixXd& symmetric);

/// Solution of a symmetric and definite system.
Eigen::VectorXd solve_definite(const Eigen::MatrixXd& symmetric, const Eigen::VectorXd& right);

/// How many numbers Eigen's functions take at a time in the unit of these.
int numbers_at_a_time();

struct SparseEntry {
  int row = 0, column = 0;
  double value = 0;
};
/// Solution of a sparse, symmetric and definite system. @param entries  of both triangles, or of the lower one
Eigen::VectorXd solve_sparse(const std::vector<SparseEntry>& entries, const Eigen::VectorXd& right);

}  // namespace scree::oracle
