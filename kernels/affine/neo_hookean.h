#pragma once
// Elastic energy of a linear tetrahedron. It is an affine body whose A is its deformation gradient, so that its energy is one of
// the columns of A: compressible and neo-Hookean,
//   V = mu/2 (tr A^T A - 3) - mu ln J + lambda/2 (ln J)^2,  J = det A.
// docs/theory.md, "Elastic bodies".
// Source: Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, section 6.4.3.

#include "kernels/affine/orthogonality.h"

namespace scree::affine {

/// Parameters of Lame times the volume at rest [J].
struct Lame {
  double shear = 0;   ///< mu
  double volume = 0;  ///< lambda

  SCREE_HD bool is_elastic() const { return shear > 0; }
};

/// Energy of what is flat or inside out: above all others.
inline constexpr double kInvertedEnergy = 1e290;

SCREE_HD inline double neo_hookean_energy(const Lame& lame, const AffineVec& q) {
  const double j = determinant(q);
  if (!(j > 0)) return kInvertedEnergy;
  const double log_j = std::log(j);
  const double stretch = strain(q, 0, 0) + strain(q, 1, 1) + strain(q, 2, 2);
  return lame.shear * (0.5 * stretch - log_j) + 0.5 * lame.volume * log_j * log_j;
}

/// mu (A - A^-T) + lambda ln J A^-T; nothing on the center. J must be positive.
SCREE_HD inline AffineVec neo_hookean_gradient(const Lame& lame, const AffineVec& q) {
  const double j = determinant(q), pull = (lame.volume * std::log(j) - lame.shear) / j;
  AffineVec g;
  for (int k = 1; k < 4; ++k) g.node[k] = lame.shear * q.node[k] + pull * cofactor(q, k);
  return g;
}

/// The positive semidefinite matrix nearest to the second derivatives with respect to the columns of A. With A = U diag(s) V^T and
/// c = mu - lambda ln J these are mu +- c / (s_i s_j) on (u_i v_j^T +- u_j v_i^T) / sqrt(2), and on the three u_i v_i^T the
/// matrix of entries lambda / (s_i s_j) with mu + c / s_i^2 more on the diagonal.
/// Source: Smith, de Goes and Kim, Analytic eigensystems for isotropic distortion energies, ACM TOG 38(1), 2019.
SCREE_HD inline Dense<9> projected_neo_hookean_hessian(const Lame& lame, const AffineVec& q) {
  const SignedSvd d = signed_svd(q);
  const double c = lame.shear - lame.volume * std::log(d.s[0] * d.s[1] * d.s[2]);
  Dense<9> h;
  Dense<3> scaling;
  double own[3][9];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    double even[9], odd[9];
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) {
        const double ij = d.u[i][m] * d.v[j][k], ji = d.u[j][m] * d.v[i][k];
        own[i][3 * k + m] = d.u[i][m] * d.v[i][k];
        even[3 * k + m] = ij + ji, odd[3 * k + m] = ij - ji;
      }
    }
    const double mixed = c / (d.s[i] * d.s[j]);
    const double on_even = lame.shear + mixed > 0 ? 0.5 * (lame.shear + mixed) : 0;
    const double on_odd = lame.shear - mixed > 0 ? 0.5 * (lame.shear - mixed) : 0;
    for (int a = 0; a < 9; ++a)
      for (int b = 0; b < 9; ++b) h(a, b) += on_even * even[a] * even[b] + on_odd * odd[a] * odd[b];
    for (int k = 0; k < 3; ++k) scaling(i, k) = lame.volume / (d.s[i] * d.s[k]);
    scaling(i, i) += lame.shear + c / (d.s[i] * d.s[i]);
  }
  project_semidefinite(scaling);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 9; ++a)
        for (int b = 0; b < 9; ++b) h(a, b) += scaling(i, k) * own[i][a] * own[k][b];
  return h;
}

}  // namespace scree::affine
