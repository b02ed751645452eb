#pragma once
// Exact solutions of problems with one contact: what Gauss-Seidel methods do at every contact.

#include "solvers/assembled/assembled_measures.h"

namespace scree {

/// r with u = W r + b under the law of the model, for one contact.
///
/// Open and sticking contacts are told by their conditions. For a slipping one u_t = -l r_t with
/// one unknown l > 0, and r follows from l by a 3x3 system; the condition |r_t| = mu r_n changes
/// its sign over a known interval of l, so that a bracketing method always finds a root of it. With
///   exact    u_n = 0:           l in (0, inf), where W_nn > 0 and the Schur complement of W_tt is
///                               positive definite; W may be unsymmetric
///   convex   u_n = mu^2 l r_n:  l on one side of the pole of r_n(l); W symmetric positive definite
/// A block whose W_nn is not positive cannot be solved: r is then left as it is.
/// @param W   block of the contact [1/kg]
/// @param b   velocity without this contact [3] [m/s]
/// @param r   in: any; out: impulse [3] [N s]
/// Source: own; the slip condition as in Bonnefon and Daviet, "Quartic formulation of Coulomb 3D
/// frictional contact", INRIA 2011, but bracketed instead of expanded.
void solve_one_contact(AssembledModel model, const Block3& W, const double* b, double mu,
                       double* r);

}  // namespace scree
