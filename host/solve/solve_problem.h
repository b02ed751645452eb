#pragma once
// Several solvers on one stored problem.

#include <optional>
#include <string>
#include <vector>

#include "host/problems/stored_problem.h"
#include "solvers/assembled/assembled_solver.h"
#include "solvers/rolling/rolling_problem.h"

namespace scree {

/// A stored problem made ready to be solved.
struct ReadyProblem {
  std::string name;
  AssembledProblem problem;               ///< with rolling friction all but W, q and mu
  std::optional<RollingProblem> rolling;  ///< five rows a contact, where the file has those
  double asymmetry = 0;                   ///< largest |W - W^T| over largest |W|
  std::vector<double> guess;              ///< stored one, in rows of the problem; empty: none
  /// What velocity errors are measured against: u of a stored solution of the exact model, or what
  /// find_reference found; empty: nothing.
  std::vector<double> reference_velocity;
  /// Of find_reference; r of stored solutions is unreliable.
  std::vector<double> reference_impulse;
  AssembledModel reference_model = AssembledModel::exact;
};

/// @throws InputError as assembled_form
ReadyProblem ready(const std::string& name, const StoredProblem& stored);

/// A problem with bodies for matrix-free solvers alone where it has rolling friction, which W does
/// not hold: all but the matrices. As ready() otherwise.
ReadyProblem ready_matrix_free(const std::string& name, const StoredProblem& stored);

/// What one solver did.
struct SolverRun {
  std::string solver;
  std::string friction = "cone";  ///< AssembledTraits::friction
  std::string backend = "cpu";    ///< where it ran: cpu or cuda
  AssembledResult result;
  std::vector<AssembledCurvePoint> curve;
};

/// Takes what a solver reaches as the reference of a problem: to a residual of 1e-13, or in its own
/// number of iterations and the seconds of the options.
/// @return what it reached
/// @throws InputError as run_solvers
SolverRun find_reference(ReadyProblem& problem, const std::string& solver,
                         const AssembledOptions& options);

/// u of impulses in rows of the problem; of the convex model with the symmetric part of W.
std::vector<double> velocity_of(const ReadyProblem& problem, AssembledModel model,
                                const std::vector<double>& r);

/// Runs solvers by name one after another, each from the guess of the options.
/// @throws InputError naming an unknown solver and the known ones, one that has no form for the
///         target or does not take rolling friction or bilateral rows, or an option out of range
std::vector<SolverRun> run_solvers(const ReadyProblem& problem,
                                   const std::vector<std::string>& solvers,
                                   const AssembledOptions& options,
                                   const AssembledTarget& target = {});

/// Names of solvers that take problems with bilateral rows.
std::vector<std::string> solvers_that_hold_rows();

/// Those of the names that make_assembled_solver does not know for CUDA.
std::vector<std::string> without_cuda_form(const std::vector<std::string>& names);

/// Those of the names whose method has a relaxation.
std::vector<std::string> with_relaxation(const std::vector<std::string>& names);

/// Names of a comma-separated list, each once; "all" stands for every known solver.
/// @throws InputError naming a name that is unknown or empty, and the known ones
std::vector<std::string> parse_solver_list(
    const std::string& list, const std::vector<std::string>& known = assembled_solver_names());

}  // namespace scree
