#pragma once
// The solvers of simulation steps on a stored problem with bodies, without assembling W: on either
// backend and in either precision, judged like all others.

#include <memory>
#include <string>
#include <vector>

#include "host/problems/body_problem.h"
#include "host/solve/solve_problem.h"
#include "host/world.h"

namespace scree {

/// Impulses that a solver reached, and what it took.
struct MatrixFreeSolution {
  std::vector<Vec3d> impulse;  ///< world frame, acting on B [N s]
  int iterations = 0;
  int applications = 0;
  double seconds = 0;  ///< of the solve, transfers excluded
};

/// A problem in the memory of a backend.
class MatrixFreeProblem {
 public:
  virtual ~MatrixFreeProblem() = default;

  /// Solves from a guess until the iterations are done.
  /// @param solver  a name of solver_names()
  /// @param guess   world frame [contact_count]; empty: zero
  /// @param limit   convex model: most iterations; exact model: most outer iterations of the De
  ///                Saxce fixed point, whose inner solves take at most inner_limit
  virtual MatrixFreeSolution solve(const std::string& solver, AssembledModel model,
                                   const std::vector<Vec3d>& guess, int limit, int inner_limit) = 0;
};

/// @throws InputError when the backend is not there
std::unique_ptr<MatrixFreeProblem> upload_matrix_free(const BodyProblem& problem,
                                                      const WorldOptions& world);

/// Compiled once per backend: B is Cpu or Cuda.
template <class B>
std::unique_ptr<MatrixFreeProblem> upload_matrix_free_on(const BodyProblem& problem,
                                                         const WorldOptions& world);

/// Runs solvers one after another. Every point of a curve is a run of its own from the guess, with
/// its own limit (1, 2, 3, 5, 7, 10, 14, ...), so that seconds are those of a solve which is
/// stopped there; a solver is done when a run reaches the tolerance.
/// @param ready    the same problem, which measures
/// @param solvers  names of solver_names()
/// @param options  max_iterations 0 stands for 10,000, outer iterations of the exact model for 100
/// @throws InputError when the backend is not there, or a solver cannot take the problem there
std::vector<SolverRun> run_matrix_free(const BodyProblem& problem, const ReadyProblem& ready,
                                       const std::vector<std::string>& solvers,
                                       const AssembledOptions& options, const WorldOptions& world);

}  // namespace scree
