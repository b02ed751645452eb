#pragma once
// Conjugate projected gradient on friction pyramids.

#include "solvers/assembled/assembled_solver.h"

namespace scree {

/// The law of pgs_pyramid_method.h, over impulses in place of multipliers: these are not unique
/// inside of a pyramid, and block directions that impulses may take. For the convex model that is
/// one quadratic program. For the exact one the lift of the normal row stands still and is taken
/// anew whenever the error of the program has fallen to a tenth.
/// @param sides  even, 4 or more
void run_cpg_pyramid(const AssembledProblem& problem, const AssembledOptions& options, int sides,
                     AssembledMonitor& monitor);

}  // namespace scree
