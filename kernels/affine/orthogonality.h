#pragma once
// The energy that keeps an affine body nearly rigid, V = k |A^T A - I|^2, with k = kappa times the
// volume [J]. docs/theory.md, "Affine bodies".

#include "kernels/affine/affine_state.h"
#include "kernels/math/dense.h"

namespace scree::affine {

/// Entry of A^T A - I. @param k, l  columns, from 0
SCREE_HD inline double strain(const AffineVec& q, int k, int l) {
  return dot(q.node[k + 1], q.node[l + 1]) - (k == l ? 1 : 0);
}

/// Frobenius norm of A^T A - I [-]: how far from rigid the body is.
SCREE_HD inline double strain_norm(const AffineVec& q) {
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) sum += strain(q, k, l) * strain(q, k, l);
  return std::sqrt(sum);
}

SCREE_HD inline double orthogonality_energy(double stiffness, const AffineVec& q) {
  const double s = strain_norm(q);
  return stiffness * s * s;
}

/// 4 k A (A^T A - I); nothing on the center of mass.
SCREE_HD inline AffineVec orthogonality_gradient(double stiffness, const AffineVec& q) {
  AffineVec g;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) g.node[k + 1] += (4 * stiffness * strain(q, k, l)) * q.node[l + 1];
  return g;
}

/// Second derivatives with respect to the columns of A, as they are.
SCREE_HD inline Dense<9> orthogonality_hessian(double stiffness, const AffineVec& q) {
  const double s = 4 * stiffness;
  Dense<9> h;
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      h.add_identity(k, l, s * strain(q, k, l));
      h.add_outer(k, l, s, q.node[l + 1], q.node[k + 1]);
    }
    for (int m = 1; m < 4; ++m) h.add_outer(k, k, s, q.node[m], q.node[m]);
  }
  return h;
}

/// A = U diag(s) V^T with two rotations; the smallest s is negative where A turns space inside out.
struct SignedSvd {
  Vec3d u[3], v[3];  ///< columns
  double s[3] = {};
};

/// By rotations of the columns of A from the right until they are orthogonal.
/// Source: Hestenes, J. SIAM 6(1), 1958.
SCREE_HD inline SignedSvd signed_svd(const AffineVec& q) {
  constexpr int kSweeps = 30;  // four to six are needed
  SignedSvd r;
  Vec3d b[3] = {q.node[1], q.node[2], q.node[3]};
  for (int k = 0; k < 3; ++k) r.v[k][k] = 1;
  bool turned = true;
  for (int sweep = 0; sweep < kSweeps && turned; ++sweep) {
    turned = false;
    for (int k = 0; k < 3; ++k) {
      const int i = k == 2 ? 1 : 0, j = k == 0 ? 1 : 2;
      const double ii = norm2(b[i]), jj = norm2(b[j]), ij = dot(b[i], b[j]);
      if (ij * ij <= 1e-32 * ii * jj) continue;
      turned = true;
      const double zeta = (jj - ii) / (2 * ij);
      const double t = (zeta < 0 ? -1 : 1) / (std::abs(zeta) + std::sqrt(zeta * zeta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      const Vec3d bi = b[i], vi = r.v[i];
      b[i] = c * bi - s * b[j], b[j] = s * bi + c * b[j];
      r.v[i] = c * vi - s * r.v[j], r.v[j] = s * vi + c * r.v[j];
    }
  }
  int least = 0;
  for (int k = 1; k < 3; ++k) least = norm2(b[k]) < norm2(b[least]) ? k : least;
  const int next = (least + 1) % 3, last = (least + 2) % 3;
  const bool next_longer = norm2(b[next]) > norm2(b[last]);
  const int first = next_longer ? next : last, second = next_longer ? last : next;
  r.u[first] = normalized(b[first]);
  r.u[second] = normalized(b[second], any_orthogonal(r.u[first]));
  r.u[least] = cross(r.u[next], r.u[last]);
  for (int k = 0; k < 3; ++k) r.s[k] = dot(b[k], r.u[k]);
  return r;
}

/// Columns of the rotation nearest to A, U V^T: the pose of the body as a rigid one.
SCREE_HD inline void nearest_rotation(const AffineVec& q, Vec3d (&column)[3]) {
  const SignedSvd d = signed_svd(q);
  for (int l = 0; l < 3; ++l) {
    column[l] = Vec3d{};
    for (int k = 0; k < 3; ++k) column[l] += d.v[k][l] * d.u[k];
  }
}

/// Calls visit(value, mode) for each negative eigenvalue of orthogonality_hessian() in units of 4 k, and its unit eigenvector.
/// They are 3 s_i^2 - 1 on u_i v_i^T, and s_i^2 -+ s_i s_j + s_j^2 - 1 on (u_i v_j^T -+ u_j v_i^T) / sqrt(2): at a rotation 2, 0
/// and 2.
template <class Visit>
SCREE_HD void for_each_negative_mode(const AffineVec& q, Visit&& visit) {
  const SignedSvd d = signed_svd(q);
  const auto lift = [&](double value, int i, int j, double sign, double scale) {
    if (value >= 0) return;
    double mode[9];
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) {
        double e = d.u[i][m] * d.v[j][k];
        if (i != j) e += sign * d.u[j][m] * d.v[i][k];
        mode[3 * k + m] = scale * e;
      }
    }
    visit(value, mode);
  };
  const double half = std::sqrt(0.5);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double si = d.s[i], sj = d.s[j];
    lift(3 * si * si - 1, i, i, 0, 1);
    lift(si * si - si * sj + sj * sj - 1, i, j, -1, half);
    lift(si * si + si * sj + sj * sj - 1, i, j, 1, half);
  }
}

/// The positive semidefinite matrix nearest to orthogonality_hessian().
SCREE_HD inline Dense<9> projected_orthogonality_hessian(double stiffness, const AffineVec& q) {
  Dense<9> h = orthogonality_hessian(stiffness, q);
  for_each_negative_mode(q, [&](double value, const double(&mode)[9]) {
    for (int a = 0; a < 9; ++a)
      for (int b = 0; b < 9; ++b) h(a, b) -= 4 * stiffness * value * mode[a] * mode[b];
  });
  return h;
}

/// Line i of that matrix.
SCREE_HD inline void projected_orthogonality_line(double stiffness, const AffineVec& q, int i,
                                                  double (&line)[9]) {
  const double s = 4 * stiffness;
  const int k = i / 3, m = i % 3;
  for (int l = 0; l < 3; ++l) {
    for (int n = 0; n < 3; ++n) {
      double& entry = line[3 * l + n];
      entry = (m == n ? s * strain(q, k, l) : 0) + s * q.node[l + 1][m] * q.node[k + 1][n];
      for (int c = 1; c < 4 && l == k; ++c) entry += s * q.node[c][m] * q.node[c][n];
    }
  }
  for_each_negative_mode(q, [&](double value, const double(&mode)[9]) {
    double own = 0;  // chosen so, the mode stays in registers
    for (int a = 0; a < 9; ++a) own = a == i ? mode[a] : own;
    for (int b = 0; b < 9; ++b) line[b] -= 4 * stiffness * value * own * mode[b];
  });
}

}  // namespace scree::affine
