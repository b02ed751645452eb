#pragma once
// Problems with bilateral rows made of dense matrices, and what dense matrices say about them.

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "host/problems/matrix_problem.h"
#include "tests/reference/dense_algebra.h"

namespace scree::fixtures {

struct HeldOptions {
  int contacts = 6;
  int held = 5;       ///< bilateral rows that are independent
  int dependent = 0;  ///< more rows, sums of those
  int velocities = 30;
  double wrong = 0;  ///< how much the last dependent row asks for beside what the others do [m/s]
  int dimension = 3;
  unsigned seed = 1;
};

/// M v = H r + G l + f, u = H^T v + w, 0 = G^T v + b with random matrices.
struct DenseGlobal {
  Eigen::MatrixXd M, H, G;
  Eigen::VectorXd f, w, b, mu;
  int dimension = 3;
};

inline DenseGlobal random_held(const HeldOptions& o) {
  std::mt19937 generator(o.seed);
  std::normal_distribution<double> normal;
  const auto matrix = [&](int rows, int columns) {
    Eigen::MatrixXd m(rows, columns);
    for (double& x : m.reshaped()) x = normal(generator);
    return m;
  };
  const int n = o.velocities, rows = o.dimension * o.contacts;
  DenseGlobal p;
  p.dimension = o.dimension;
  const Eigen::MatrixXd root = matrix(n, n);
  p.M = Eigen::MatrixXd::Identity(n, n) + 0.1 / n * root * root.transpose();
  p.H = matrix(n, rows);
  const Eigen::MatrixXd own = matrix(n, o.held);
  const Eigen::MatrixXd sums = matrix(o.held, o.dependent);
  p.G.resize(n, o.held + o.dependent);
  p.G << own, own * sums;
  const Eigen::VectorXd loads = matrix(o.held, 1);
  p.b.resize(o.held + o.dependent);
  p.b << loads, sums.transpose() * loads;
  if (o.dependent > 0) p.b(o.held + o.dependent - 1) += o.wrong;
  p.f = matrix(n, 1);
  p.w = matrix(rows, 1);
  p.mu = Eigen::VectorXd::LinSpaced(o.contacts, 0.2, 0.9);
  return p;
}

inline SparseMatrix sparse(const Eigen::MatrixXd& m) {
  std::vector<MatrixEntry> entries;
  for (int row = 0; row < m.rows(); ++row)
    for (int column = 0; column < m.cols(); ++column)
      if (std::abs(m(row, column)) > 0) entries.push_back({row, column, m(row, column)});
  return compress(static_cast<int>(m.rows()), static_cast<int>(m.cols()), entries);
}

inline std::vector<double> numbers(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}
inline Eigen::VectorXd vector(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

inline GlobalProblem global_of(const DenseGlobal& p) {
  GlobalProblem g;
  g.dimension = p.dimension;
  g.M = sparse(p.M);
  g.H = sparse(p.H);
  g.G = sparse(p.G);
  g.f = numbers(p.f);
  g.w = numbers(p.w);
  g.b = numbers(p.b);
  g.mu = numbers(p.mu);
  return g;
}

/// Contacts alone: with l eliminated by a full pseudoinverse of the KKT matrix [M -G; G^T 0], the
/// velocities are v = A r + a.
struct DenseContacts {
  Eigen::MatrixXd W;
  Eigen::VectorXd q, mu;
  int dimension = 3;

  explicit DenseContacts(const DenseGlobal& p) : mu(p.mu), dimension(p.dimension) {
    const Eigen::Index n = p.M.rows(), m = p.G.cols();
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + m, n + m);
    kkt.topLeftCorner(n, n) = p.M;
    kkt.topRightCorner(n, m) = -p.G;
    kkt.bottomLeftCorner(m, n) = p.G.transpose();
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n + m, p.H.cols() + 1);
    right.topLeftCorner(n, p.H.cols()) = p.H;
    right.col(p.H.cols()) << p.f, -p.b;
    const Eigen::MatrixXd v = oracle::least_norm(kkt, right).topRows(n);
    W = p.H.transpose() * v.leftCols(p.H.cols());
    q = p.w + p.H.transpose() * v.col(p.H.cols());
  }

  /// Nearest point of |x_t| <= mu x_n, by its definition.
  Eigen::VectorXd projected(Eigen::VectorXd x) const {
    for (Eigen::Index c = 0; c < mu.size(); ++c) {
      auto own = x.segment(c * dimension, dimension);
      const double t = own.tail(dimension - 1).norm();
      if (t <= mu(c) * own(0)) continue;
      // The foot on the ray (1, mu) / |.| within the half-plane of n and t.
      const double along = (own(0) + mu(c) * t) / (1 + mu(c) * mu(c));
      if (along <= 0) {
        own.setZero();
        continue;
      }
      own.tail(dimension - 1) *= mu(c) * along / t;
      own(0) = along;
    }
    return x;
  }

  /// The minimum of r.W r / 2 + q.r on the cones: projected gradient with steps 1 / |W|.
  Eigen::VectorXd solve_convex() const {
    const Eigen::MatrixXd S = 0.5 * (W + W.transpose());
    const double step = 1 / S.norm();
    Eigen::VectorXd r = Eigen::VectorXd::Zero(q.size());
    for (int k = 0; k < 1'000'000; ++k) {
      const Eigen::VectorXd next = projected(r - step * (S * r + q));
      const double moved = (next - r).norm();
      r = next;
      if (moved < 1e-14 * (1 + r.norm())) break;
    }
    return r;
  }

  /// |r - P(r - v)| of Coulomb's law, or of the convex model.
  double residual(const Eigen::VectorXd& r, bool exact) const {
    Eigen::VectorXd v = W * r + q;
    for (Eigen::Index c = 0; exact && c < mu.size(); ++c)
      v(c * dimension) += mu(c) * v.segment(c * dimension + 1, dimension - 1).norm();
    return (r - projected(r - v)).norm();
  }
};

}  // namespace scree::fixtures
