#pragma once
// One pass of block Gauss-Seidel over all contacts.

#include "solvers/assembled/assembled_measures.h"

namespace scree {

/// Solves contact after contact exactly with the others held, and moves by `relaxation` times the
/// change; the result is projected where that is not 1. One product with W.
/// @param backward  from the last contact to the first
/// @param r         impulses, in and out [3 contact_count]
/// @return          |change| of this pass in the metric of contact_scales, over |r| in the same
double sweep(const AssembledProblem& p, AssembledModel model, double relaxation, bool backward,
             std::vector<double>& r);

}  // namespace scree
