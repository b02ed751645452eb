#pragma once
// How far impulses are from a solution of a problem with bodies, without matrices.

#include <vector>

#include "host/problems/body_problem.h"
#include "solvers/assembled/assembled_measures.h"

namespace scree {

/// The residual of simulation steps (Residual in solvers/solver.h) in all layouts, in double on the
/// CPU. For rolling friction, whose moments no matrix form holds.
/// @param impulse  world vectors, vectors_per_contact each
/// @return  absolute: the natural map as a velocity [m/s], over all contacts; relative and
///          unit_free: the same over the velocity of all contacts without impulses; to_largest:
///          over that or the present one, whichever is larger; objective: of the convex model
AssembledResidual measure(const BodyProblem& problem, AssembledModel model,
                          const std::vector<Vec3d>& impulse);

/// The numbers of world vectors, one after another.
std::vector<double> world_numbers(const std::vector<Vec3d>& vectors);

}  // namespace scree
