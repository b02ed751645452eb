#pragma once
// Small square matrices of fixed size, their eigenvectors, and the nearest positive semidefinite
// ones.

#include <cmath>

#include "kernels/math/vec3.h"

namespace scree {

/// A square matrix, row by row.
template <int N>
struct Dense {
  double entry[N * N] = {};

  SCREE_HD double& operator()(int i, int j) { return entry[N * i + j]; }
  SCREE_HD double operator()(int i, int j) const { return entry[N * i + j]; }

  SCREE_HD void add(const Dense& o) {
    for (int k = 0; k < N * N; ++k) entry[k] += o.entry[k];
  }
  SCREE_HD void scale(double s) {
    for (double& e : entry) e *= s;
  }
  /// Adds s a b^T to the 3x3 block whose first entry is (3 row, 3 column).
  SCREE_HD void add_outer(int row, int column, double s, const Vec3<double>& a,
                          const Vec3<double>& b) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) (*this)(3 * row + i, 3 * column + j) += s * a[i] * b[j];
  }
  /// Adds s times the identity to that block.
  SCREE_HD void add_identity(int row, int column, double s) {
    for (int i = 0; i < 3; ++i) (*this)(3 * row + i, 3 * column + i) += s;
  }
};

/// Diagonalizes a symmetric matrix by cyclic Jacobi rotations.
/// @param a        in: the matrix; out: its eigenvalues on the diagonal
/// @param vectors  out: eigenvectors in its columns
/// Source: Golub and Van Loan, Matrix Computations, section 8.5.
template <int N>
SCREE_HD void diagonalize(Dense<N>& a, Dense<N>& vectors) {
  constexpr int kSweeps = 30;  // converges quadratically: six to ten are needed
  vectors = Dense<N>{};
  for (int i = 0; i < N; ++i) vectors(i, i) = 1;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double off = 0, on = 0;
    for (int i = 0; i < N; ++i) {
      on += a(i, i) * a(i, i);
      for (int j = 0; j < i; ++j) off += a(i, j) * a(i, j);
    }
    if (off <= 1e-36 * on) return;
    for (int p = 0; p < N; ++p) {
      for (int q = p + 1; q < N; ++q) {
        if (a(p, q) == 0) continue;
        const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < N; ++k) {
          const double kp = a(k, p), kq = a(k, q);
          a(k, p) = c * kp - s * kq;
          a(k, q) = s * kp + c * kq;
        }
        for (int k = 0; k < N; ++k) {
          const double pk = a(p, k), qk = a(q, k);
          a(p, k) = c * pk - s * qk;
          a(q, k) = s * pk + c * qk;
        }
        for (int k = 0; k < N; ++k) {
          const double kp = vectors(k, p), kq = vectors(k, q);
          vectors(k, p) = c * kp - s * kq;
          vectors(k, q) = s * kp + c * kq;
        }
        a(p, q) = a(q, p) = 0;
      }
    }
  }
}

/// Makes a symmetric matrix the nearest positive semidefinite one: negative eigenvalues become zero.
template <int N>
SCREE_HD void project_semidefinite(Dense<N>& h) {
  Dense<N> values = h, vectors;
  diagonalize(values, vectors);
  for (int k = 0; k < N; ++k) {
    if (values(k, k) >= 0) continue;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) h(i, j) -= values(k, k) * vectors(i, k) * vectors(j, k);
  }
}

}  // namespace scree
