#pragma once
// Second derivatives of pairs as whole matrices, and the nearest semidefinite ones by their eigenvalues: what the modes of
// kernels/affine/contact_modes.h are held to, and what AffineSystem takes.

#include "kernels/affine/contact_potential.h"
#include "kernels/affine/friction.h"
#include "kernels/math/dense.h"

namespace scree::affine {

/// How second derivatives are made positive semidefinite.
enum class Projection : std::uint8_t {
  none,         ///< as they are
  eigenvalues,  ///< the nearest semidefinite matrix
  gauss_newton  ///< the second derivative along the normal only, a matrix of rank one
};

/// Second derivatives of the squared distance. With F = |sum of w_i x_i|^2 at parameters b, which
/// follow the points, they are F_xx - F_xb F_bb^-1 F_bx.
SCREE_HD inline Dense<12> distance_hessian(const Four& x, const Nearest& n) {
  Dense<12> h;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) h.add_identity(i, j, 2 * n.weight[i] * n.weight[j]);
  if (n.free == 0) return h;
  Vec3d along[2];  // derivatives of the gap with respect to the parameters
  for (int k = 0; k < n.free; ++k)
    for (int i = 0; i < 4; ++i)
      if (i > 0) along[k] += n.slope[k][i] * (x[i] - x[0]);
  double inverse[2][2] = {};  // of F_bb / 2
  const double aa = norm2(along[0]), bb = norm2(along[1]), ab = dot(along[0], along[1]);
  if (n.free == 1) {
    inverse[0][0] = 1 / aa;
  } else {
    const double area = norm2(cross(along[0], along[1]));
    inverse[0][0] = bb / area, inverse[1][1] = aa / area;
    inverse[0][1] = inverse[1][0] = -ab / area;
  }
  Four mixed[2];  // F_xb / 2
  for (int k = 0; k < n.free; ++k)
    for (int i = 0; i < 4; ++i) mixed[k][i] = n.slope[k][i] * n.gap + n.weight[i] * along[k];
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < n.free; ++k)
        for (int l = 0; l < n.free; ++l)
          h.add_outer(i, j, -2 * inverse[k][l], mixed[k][i], mixed[l][j]);
  return h;
}

/// Second derivatives of c = |e|^2 |f|^2 - (e.f)^2 with respect to the four points.
SCREE_HD inline Dense<12> cross_hessian(const Four& x) {
  const Vec3d e = x[1] - x[0], f = x[3] - x[2];
  const double ee = norm2(e), ff = norm2(f), ef = dot(e, f);
  Dense<12> h;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double sign = (i + j) % 2 == 0 ? 1 : -1;
      if (i < 2 && j < 2) {
        h.add_identity(i, j, 2 * sign * ff);
        h.add_outer(i, j, -2 * sign, f, f);
      } else if (i >= 2 && j >= 2) {
        h.add_identity(i, j, 2 * sign * ee);
        h.add_outer(i, j, -2 * sign, e, e);
      } else {
        const Vec3d &own = i < 2 ? e : f, &other = i < 2 ? f : e;
        h.add_identity(i, j, -2 * sign * ef);
        h.add_outer(i, j, 4 * sign, own, other);
        h.add_outer(i, j, -2 * sign, other, own);
      }
    }
  }
  return h;
}

/// Five orthonormal vectors of four points each, in whose span all is that a pair without mollifier
/// has of second derivatives: along the normal for the weights and their slopes, and across it for
/// the weights.
SCREE_HD inline void contact_basis(const Nearest& n, Four (&basis)[5]) {
  const Vec3d normal = normalized(n.gap), across = any_orthogonal(normal);
  const Vec3d directions[3] = {normal, across, cross(normal, across)};
  double w[3][4] = {};
  for (int k = 0; k <= n.free; ++k) {
    for (int i = 0; i < 4; ++i) w[k][i] = k == 0 ? n.weight[i] : n.slope[k - 1][i];
    for (int turn = 0; turn < 2; ++turn) {  // twice: the vectors may be nearly parallel
      for (int l = 0; l < k; ++l) {
        double along = 0;
        for (int i = 0; i < 4; ++i) along += w[k][i] * w[l][i];
        for (int i = 0; i < 4; ++i) w[k][i] -= along * w[l][i];
      }
      double length = 0;
      for (int i = 0; i < 4; ++i) length += w[k][i] * w[k][i];
      for (int i = 0; i < 4; ++i) w[k][i] /= std::sqrt(length);
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) basis[k][i] = w[k][i] * directions[0];
    for (int k = 1; k < 3; ++k) basis[2 + k][i] = w[0][i] * directions[k];
  }
}

/// Makes the Hessian of a pair without mollifier semidefinite, by eigenvalues of a 5x5 matrix.
SCREE_HD inline void project_contact(const Nearest& n, Dense<12>& h) {
  Four basis[5];
  contact_basis(n, basis);
  Dense<5> small;
  for (int l = 0; l < 5; ++l) {
    double image[12];
    for (int a = 0; a < 12; ++a) {
      image[a] = 0;
      for (int b = 0; b < 12; ++b) image[a] += h(a, b) * basis[l][b / 3][b % 3];
    }
    for (int k = 0; k < 5; ++k)
      for (int a = 0; a < 12; ++a) small(k, l) += basis[k][a / 3][a % 3] * image[a];
  }
  Dense<5> vectors;
  diagonalize(small, vectors);
  for (int k = 0; k < 5; ++k) {
    if (small(k, k) >= 0) continue;
    Four mode;
    for (int i = 0; i < 4; ++i)
      for (int l = 0; l < 5; ++l) mode[i] += vectors(l, k) * basis[l][i];
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) h.add_outer(i, j, -small(k, k), mode[i], mode[j]);
  }
}

/// Second derivative of the barrier energy with respect to the distance itself, not below zero: the
/// factor of (w_i w_j) n n^T in the Gauss-Newton matrix.
SCREE_HD inline double normal_stiffness(const ContactPair& pair, const Barrier& barrier,
                                        const Nearest& n, const Mollifier& m) {
  const Derivatives b = barrier(n.squared);
  const double k = pair.weight * m.value * (4 * b.second * n.squared + 2 * b.first);
  return k > 0 ? k : 0;
}

SCREE_HD inline Dense<12> contact_hessian(const ContactPair& pair, const Barrier& barrier,
                                          const Four& x, Projection projection) {
  const Nearest n = nearest_points(pair.kind, x);
  Dense<12> h;
  if (!barrier.acts(n.squared)) return h;
  const Derivatives b = barrier(n.squared);
  const Mollifier m = mollifier(pair, x);
  if (projection == Projection::gauss_newton) {
    const Vec3d normal = normalized(n.gap);
    const double k = normal_stiffness(pair, barrier, n, m);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) h.add_outer(i, j, k * n.weight[i] * n.weight[j], normal, normal);
    return h;
  }
  const Four d = distance_gradient(n);
  h = distance_hessian(x, n);
  h.scale(pair.weight * m.value * b.first);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) h.add_outer(i, j, pair.weight * m.value * b.second, d[i], d[j]);
  if (m.first == 0) {
    if (projection != Projection::none) project_contact(n, h);
    return h;
  }
  const Four c = cross_gradient(x);
  Dense<12> turning = cross_hessian(x);
  turning.scale(pair.weight * b.value * m.first);
  h.add(turning);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      h.add_outer(i, j, pair.weight * b.value * m.second, c[i], c[j]);
      h.add_outer(i, j, pair.weight * b.first * m.first, c[i], d[j]);
      h.add_outer(i, j, pair.weight * b.first * m.first, d[i], c[j]);
    }
  }
  if (projection == Projection::eigenvalues) project_semidefinite(h);
  return h;
}

/// The 3x3 matrix K of the pair: blocks of the Hessian are w_i w_j K. Along the slip it is f1', across
/// it f1 / y, both never below zero: it needs no projection.
SCREE_HD inline Dense<3> friction_stiffness(const FrictionContact& f, const SlipLaw& law,
                                            const Four& moved) {
  double u[2];
  slip_of(f, moved, u);
  const double y = std::sqrt(u[0] * u[0] + u[1] * u[1]);
  const double across = f.bound * law.force_per_slip(y);
  const double along = f.bound * law.stiffness(y);
  Dense<3> k;
  k.add_outer(0, 0, across, f.tangent[0], f.tangent[0]);
  k.add_outer(0, 0, across, f.tangent[1], f.tangent[1]);
  if (y > 0) {
    const Vec3d direction = (u[0] / y) * f.tangent[0] + (u[1] / y) * f.tangent[1];
    k.add_outer(0, 0, along - across, direction, direction);
  }
  return k;
}

SCREE_HD inline Dense<12> friction_hessian(const FrictionContact& f, const SlipLaw& law,
                                           const Four& moved) {
  const Dense<3> k = friction_stiffness(f, law, moved);
  Dense<12> h;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) h(i, j) = f.weight[i / 3] * f.weight[j / 3] * k(i % 3, j % 3);
  return h;
}

}  // namespace scree::affine
