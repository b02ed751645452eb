#pragma once
// Barrier energy of one pair, with gradient and Hessian for its four points.
// docs/theory.md, "Barrier contact".

#include "kernels/affine/barrier.h"
#include "kernels/affine/mollifier.h"

namespace scree::affine {

/// What does not change of a pair.
struct ContactPair {
  PairKind kind = PairKind::point_triangle;
  double weight = 1;          ///< area of the pair [m^2] with the physical barrier, or a number
  double parallel_below = 0;  ///< of edges: mollifier_threshold() [m^4]; zero: no factor
};

/// How second derivatives are made positive semidefinite.
enum class Projection : std::uint8_t {
  none,         ///< as they are
  eigenvalues,  ///< the nearest semidefinite matrix
  gauss_newton  ///< the second derivative along the normal only, a matrix of rank one
};

SCREE_HD inline Mollifier mollifier(const ContactPair& pair, const Four& x) {
  return pair.kind == PairKind::edge_edge ? mollifier(pair.parallel_below, x) : Mollifier{};
}

SCREE_HD inline double contact_energy(const ContactPair& pair, const Barrier& barrier,
                                      const Four& x) {
  const double b = barrier(nearest_points(pair.kind, x).squared).value;
  return b == 0 ? 0 : pair.weight * mollifier(pair, x).value * b;
}

SCREE_HD inline Four contact_gradient(const ContactPair& pair, const Barrier& barrier,
                                      const Four& x) {
  const Nearest n = nearest_points(pair.kind, x);
  Four g;
  if (!barrier.acts(n.squared)) return g;
  const Derivatives b = barrier(n.squared);
  const Mollifier m = mollifier(pair, x);
  const Four d = distance_gradient(n);
  for (int i = 0; i < 4; ++i) g[i] = (pair.weight * m.value * b.first) * d[i];
  if (m.first != 0) {
    const Four c = cross_gradient(x);
    for (int i = 0; i < 4; ++i) g[i] += (pair.weight * m.first * b.value) * c[i];
  }
  return g;
}

/// Normal force of a pair [N], which friction takes: the barrier's slope with respect to the
/// distance itself.
SCREE_HD inline double normal_force(const ContactPair& pair, const Barrier& barrier,
                                    const Four& x) {
  const Nearest n = nearest_points(pair.kind, x);
  const double m = mollifier(pair, x).value;
  return -2 * pair.weight * m * barrier(n.squared).first * std::sqrt(n.squared);
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

}  // namespace scree::affine
