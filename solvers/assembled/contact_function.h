#pragma once
// The equations that Newton's method solves, contact by contact, with their generalized Jacobians.

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
ContactWeights contact_weights(const Block3& W, double scale);

/// Zero where the law holds. Semi-smooth; where pieces meet, one of their derivatives is taken.
///   exact    Alart-Curnier: r_n - max(0, r_n - rho_n u_n),
///            r_t - P(r_t - rho_t u_t) with P the projection on the disk of radius
///            mu max(0, r_n - rho_n u_n)
///   convex   r - P_K(r - rho u) with rho = 1 / scale
/// Source: Alart and Curnier, CMAME 92, 1991.
ContactFunction contact_function(AssembledModel model, double mu, const ContactWeights& weights,
                                 double scale, const double* r, const double* u);

}  // namespace scree
