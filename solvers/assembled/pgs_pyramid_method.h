#pragma once
// Projected Gauss-Seidel over the edges of friction pyramids.

#include "solvers/assembled/assembled_solver.h"

namespace scree {

/// Impulses of a contact are sums l_j (1, mu e_j), l_j >= 0, with e_j unit vectors at equal angles,
/// e_0 the first tangent: a pyramid inside the cone. One row a multiplier. For the convex model the
/// objective over the pyramids is minimized. For the exact one the normal row is lifted by
/// mu max_j(-e_j.u_t), which is to pyramids what De Saxce's term is to cones; it is taken anew at
/// every visit.
///
/// Runs from the guess until sweeps move nothing any more, in units of the tolerance, and says so
/// as a stall with a note: the residual is that of the cone.
/// @param sides  even, 4 or more
/// Source: Stewart and Trinkle, IJNME 39, 1996; Anitescu, Math. Program. 105, 2006 (convex).
void run_pgs_pyramid(const AssembledProblem& problem, const AssembledOptions& options, int sides,
                     AssembledMonitor& monitor);

}  // namespace scree
