#pragma once
// Problems with bodies turned into matrices, and global ones into local ones.

#include "host/problems/stored_problem.h"

namespace scree {

/// M, H, f and w of a problem with bodies: M v = H r + f, u = H^T v + w.
///
/// v holds the degrees of freedom that can move, body by body, linear before angular, in the units
/// of BodyProblem::free_velocity; those of fixed bodies and locked axes go into w with their
/// prescribed rates. Rows of contact c are 3 c .. 3 c + 2, along contact_frame(normal): velocity of
/// B against A, so u_n > 0 separates, and the impulse on B. M is the inverse of the inverse
/// inertias, so that H^T M^-1 H is the operator of the problem to rounding.
///
/// Adhesion moves the apex of a cone to -c h e_n, which FCLIB has no place for: r is the impulse
/// plus c h e_n, whose cone has its apex at zero, and f is less by H c h e_n.
/// Bilateral rows become G and b.
/// @throws InputError for the rolling layout, whose cones have no place in these forms
GlobalProblem global_form(const BodyProblem& problem);

/// W = H^T M^-1 H and q = w + H^T M^-1 f of the same, and V, R, s where rows are bilateral.
/// @throws InputError also when W would hold more than 2^31 entries
LocalProblem local_form(const BodyProblem& problem);

/// W, q and with bilateral constraints V = H^T M^-1 G, R = G^T M^-1 G, s = b + G^T M^-1 f.
/// M is factorized by a sparse LU decomposition: it need not be symmetric.
/// Rolling friction stays. @throws InputError when M is singular
LocalProblem local_form(const GlobalProblem& problem);

enum class MatrixForm { local, global };

/// A problem with bodies as an FCLIB file holds it: the form, texts that say where it comes from,
/// and its warm start as the guess (v, u, r and l).
/// @throws InputError as the forms above
StoredProblem as_matrices(const BodyProblem& problem, MatrixForm form);

/// The same for any form; what is in the form asked for stays as it is, and guesses and
/// solution come along.
/// @throws InputError as the forms above, and for a local problem that is to become global:
///         W does not say what M and H are
StoredProblem as_matrices(const StoredProblem& problem, MatrixForm form);

/// Contact rows of world vectors, one a contact.
std::vector<double> to_rows(const BodyProblem& problem, const std::vector<Vec3d>& vectors);
/// The same for impulses as the forms above have them: c h e_n added.
std::vector<double> impulse_rows(const BodyProblem& problem, const std::vector<Vec3d>& impulses);
/// World vectors of contact rows.
std::vector<Vec3d> to_world(const BodyProblem& problem, const std::vector<double>& rows);

}  // namespace scree
