#pragma once
// Solvers of contact problems with rolling friction, for both models, on the host.

#include <string>
#include <vector>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/rolling/rolling_problem.h"

namespace scree {

/// Names that solve_rolling knows: auto, nlgs, apgd, proximal.
std::vector<std::string> rolling_solver_names();

/// As AssembledSolver::solve for five rows a contact. For the convex model an unsymmetric W is
/// replaced by its symmetric part, which the result notes.
/// @param options  relaxation and tell_unsolvable have no meaning here
/// @throws AssembledError naming the known solvers when the name is none of them,
///         or when sizes disagree or an option is out of range
AssembledResult solve_rolling(const std::string& name, const RollingProblem& problem,
                              const AssembledOptions& options,
                              std::vector<AssembledCurvePoint>* curve = nullptr);

}  // namespace scree
