#pragma once
// Differences of fourth order in place of derivatives, and vectors of affine programs as Eigen's.

#include <Eigen/Dense>

#include "kernels/affine/affine_state.h"
#include "kernels/affine/nearest.h"
#include "kernels/math/dense.h"
#include "tests/reference/dense_algebra.h"

namespace scree::affine::test {

/// Derivatives of a function of vectors, one column a coordinate.
template <class F>
Eigen::MatrixXd differences(const F& f, const Eigen::VectorXd& x, double step) {
  Eigen::MatrixXd r(f(x).size(), x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const auto at = [&](double steps) {
      Eigen::VectorXd y = x;
      y(k) += steps * step;
      return Eigen::VectorXd(f(y));
    };
    r.col(k) = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step);
  }
  return r;
}

inline Eigen::VectorXd scalar(double value) { return Eigen::VectorXd::Constant(1, value); }

inline Eigen::VectorXd to_eigen(const Vec3d (&v)[4]) {
  Eigen::VectorXd r(12);
  for (int i = 0; i < 12; ++i) r(i) = v[i / 3][i % 3];
  return r;
}
inline Eigen::VectorXd to_eigen(const Four& v) { return to_eigen(v.at); }
inline Eigen::VectorXd to_eigen(const AffineVec& v) { return to_eigen(v.node); }

inline Four to_four(const Eigen::VectorXd& v) {
  Four r;
  for (int i = 0; i < 12; ++i) r[i / 3][i % 3] = v(i);
  return r;
}
inline AffineVec to_affine(const Eigen::VectorXd& v) {
  AffineVec r;
  for (int i = 0; i < 12; ++i) r.node[i / 3][i % 3] = v(i);
  return r;
}

template <int N>
Eigen::MatrixXd to_eigen(const Dense<N>& m) {
  Eigen::MatrixXd r(N, N);
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) r(i, j) = m(i, j);
  return r;
}

/// The nearest positive semidefinite matrix, by Eigen.
inline Eigen::MatrixXd semidefinite(const Eigen::MatrixXd& m) { return oracle::semidefinite(m); }

inline double lowest_eigenvalue(const Eigen::MatrixXd& m) { return oracle::eigenvalues(m)(0); }

/// |a - b| over |b|.
inline double relative_error(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

}  // namespace scree::affine::test
