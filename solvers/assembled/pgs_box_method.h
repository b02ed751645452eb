#pragma once
// Projected Gauss-Seidel, row by row, with friction bounded by a box.

#include "solvers/assembled/assembled_solver.h"

namespace scree {

/// Where the normal impulse in the bound |r_t1|, |r_t2| <= mu r_n comes from.
enum class BoxBounds {
  coupled,  ///< of the moment: the normal row of the same contact has just been solved
  lagged    ///< of the sweep before, so that a sweep has fixed bounds
};

/// Runs from the guess until sweeps move nothing any more, in units of the tolerance, and says so
/// as a stall with a note: the residual is that of another law.
void run_pgs_box(const AssembledProblem& problem, const AssembledOptions& options, BoxBounds bounds,
                 AssembledMonitor& monitor);

}  // namespace scree
