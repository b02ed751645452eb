#pragma once
// Exact Coulomb friction for solvers that only know the convex model.

#include "solvers/assembled/assembled_solver.h"

namespace scree {

/// The De Saxce fixed point: solves the convex problem with s = mu |u_t| added to the normal rows
/// of q, takes s from the new velocity, and repeats. Where W is unsymmetric the convex problem has
/// its symmetric part and q gets (W - W^T) r / 2 of the last impulses, so that the fixed point
/// belongs to W as it is. s moves by Aitken's rule, at most its whole step: it can cycle where
/// contacts work against each other. Inner problems are solved to a tenth of the present error. An
/// iteration is one convex solve, started from the last impulses, one product with W for the new
/// velocities, and two more where W is unsymmetric. Source: De Saxce and Feng, Math.
/// Comput. Modelling 28, 1998; Irons and Tuck, IJNME 1, 1969.
/// @param convex  solves the inner problems
void run_de_saxce_loop(const AssembledSolver& convex, const AssembledProblem& problem,
                       const AssembledOptions& options, AssembledMonitor& monitor);

}  // namespace scree
