#pragma once
// The mass matrix of a mechanical system as the metric of its coordinates.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace scree::variational {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// M, symmetric and positive definite, and its inverse.
class Metric {
 public:
  /// @param mass  n x n row by row, checked before
  explicit Metric(const std::vector<double>& mass, int n)
      : mass_(Eigen::Map<const Matrix>(mass.data(), n, n)),
        inverse_(mass_.llt().solve(Matrix::Identity(n, n))),
        factor_(mass_.llt().matrixL()),
        diagonal_(inverse_.diagonal()),
        is_diagonal_(mass_.isDiagonal(0)) {}

  /// out = M^-1 p
  void velocity(const Vector& p, Vector& out) const {
    if (is_diagonal_)
      out = diagonal_.cwiseProduct(p);
    else
      out.noalias() = inverse_ * p;
  }
  Vector velocity(const Vector& p) const {
    Vector v(p.size());
    velocity(p, v);
    return v;
  }
  Vector momentum(const Vector& v) const { return mass_ * v; }
  /// Norm of a velocity, whose square is twice the kinetic energy.
  double norm(const Vector& v) const { return std::sqrt(v.dot(mass_ * v)); }
  /// L^-1 p with M = L L^T: turns the metric M^-1 of momenta into the usual one.
  Matrix whitened(const Matrix& p) const { return factor_.triangularView<Eigen::Lower>().solve(p); }

 private:
  Matrix mass_, inverse_, factor_;
  Vector diagonal_;  // of the inverse
  bool is_diagonal_;
};

}  // namespace scree::variational
