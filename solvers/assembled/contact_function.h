#pragma once
// The equations that Newton's method solves, contact by contact, with their generalized Jacobians:
// on the host and on a device.

#include <algorithm>
#include <cmath>

#include "solvers/assembled/assembled_measures.h"

namespace scree {

/// Value and partial derivatives of one contact's function at (r, u).
struct ContactFunction {
  double value[3];
  Block3 by_r;
  Block3 by_u;
};

/// Weights rho of a contact, in impulse per velocity [kg].
struct ContactWeights {
  double normal = 1;
  double tangential = 1;
};

/// Inverse normal entry, and inverse of the largest stiffness in the tangent plane, of a block:
/// with them the function of a contact alone is well scaled.
SCREE_HD inline ContactWeights contact_weights(const Block3& W, double scale) {
  const double normal = std::max(W[0], 1e-6 * scale);
  const double mean = 0.5 * (W[4] + W[8]), off = 0.5 * (W[5] + W[7]);
  const double tangential = mean + std::hypot(0.5 * (W[4] - W[8]), off);
  return {1 / normal, 1 / std::max(tangential, 1e-6 * scale)};
}

namespace contact_function_parts {

SCREE_HD inline ContactFunction alart_curnier(double mu, const ContactWeights& rho, const double* r,
                                              const double* u) {
  const double x = r[0] - rho.normal * u[0];
  const double y[2] = {r[1] - rho.tangential * u[1], r[2] - rho.tangential * u[2]};
  if (!(x > 0)) return {{r[0], r[1], r[2]}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
  ContactFunction f{};
  f.value[0] = rho.normal * u[0];
  f.by_u[0] = rho.normal;
  const double radius = mu * x, size = std::hypot(y[0], y[1]);
  if (size <= radius) {
    f.value[1] = rho.tangential * u[1];
    f.value[2] = rho.tangential * u[2];
    f.by_u[4] = f.by_u[8] = rho.tangential;
    return f;
  }
  const double e[2] = {y[0] / size, y[1] / size};
  const double shrink = radius / size;
  for (int i = 0; i < 2; ++i) {
    const int row = 3 * (i + 1);
    f.value[i + 1] = r[i + 1] - radius * e[i];
    f.by_r[row] = -mu * e[i];
    f.by_u[row] = mu * rho.normal * e[i];
    for (int j = 0; j < 2; ++j) {
      const double turn = shrink * ((i == j ? 1.0 : 0.0) - e[i] * e[j]);
      f.by_r[row + 1 + j] = (i == j ? 1.0 : 0.0) - turn;
      f.by_u[row + 1 + j] = rho.tangential * turn;
    }
  }
  return f;
}

SCREE_HD inline ContactFunction natural_map(double mu, double rho, const double* r,
                                            const double* u) {
  const double x = r[0] - rho * u[0];
  const double y[2] = {r[1] - rho * u[1], r[2] - rho * u[2]};
  const double size = std::hypot(y[0], y[1]);
  if (mu * size <= -x) return {{r[0], r[1], r[2]}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
  ContactFunction f{};
  if (size <= mu * x) {
    for (int k = 0; k < 3; ++k) {
      f.value[k] = rho * u[k];
      f.by_u[4 * k] = rho;
    }
    return f;
  }
  const double e[2] = {y[0] / size, y[1] / size};
  const double n = (x + mu * size) / (1 + mu * mu), shrink = mu * n / size;
  Block3 slope{};  // of the projection
  slope[0] = 1 / (1 + mu * mu);
  for (int i = 0; i < 2; ++i) {
    slope[1 + i] = mu * e[i] / (1 + mu * mu);
    slope[3 * (i + 1)] = slope[1 + i];
    for (int j = 0; j < 2; ++j)
      slope[3 * (i + 1) + 1 + j] =
          mu * mu / (1 + mu * mu) * e[i] * e[j] + shrink * ((i == j ? 1.0 : 0.0) - e[i] * e[j]);
  }
  f.value[0] = r[0] - n;
  f.value[1] = r[1] - mu * n * e[0];
  f.value[2] = r[2] - mu * n * e[1];
  for (int k = 0; k < 9; ++k) {
    f.by_r[k] = (k % 4 == 0 ? 1 : 0) - slope[k];
    f.by_u[k] = rho * slope[k];
  }
  return f;
}

}  // namespace contact_function_parts

/// Zero where the law holds. Semi-smooth; where pieces meet, one of their derivatives is taken.
///   exact    Alart-Curnier: r_n - max(0, r_n - rho_n u_n),
///            r_t - P(r_t - rho_t u_t) with P the projection on the disk of radius
///            mu max(0, r_n - rho_n u_n)
///   convex   r - P_K(r - rho u) with rho = 1 / scale
/// Source: Alart and Curnier, CMAME 92, 1991.
SCREE_HD inline ContactFunction contact_function(AssembledModel model, double mu,
                                                 const ContactWeights& weights, double scale,
                                                 const double* r, const double* u) {
  if (model == AssembledModel::exact)
    return contact_function_parts::alart_curnier(mu, weights, r, u);
  return contact_function_parts::natural_map(mu, 1 / scale, r, u);
}

/// The same of a contact whose diagonal block of W is given, for element programs.
struct ConeFunction {
  static constexpr const char* other_law = nullptr;  ///< name of the law where it is not the cone's
  AssembledModel model;
  SCREE_HD ContactFunction operator()(double mu, const Block3& W, double scale, const double* r,
                                      const double* u) const {
    return contact_function(model, mu, contact_weights(W, scale), scale, r, u);
  }
};

}  // namespace scree
