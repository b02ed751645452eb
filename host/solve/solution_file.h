#pragma once
// Solutions of contact problems as files: what a solver reached, for others to go on with and to be
// measured against.

#include <filesystem>
#include <string>
#include <vector>

#include "host/solve/solve_problem.h"

namespace scree {

/// Impulses and velocities, in the rows of the problem's file: normal, one or two tangents,
/// two of rolling.
struct Solution {
  std::string problem;  ///< name of the problem; empty when the file does not say
  std::string solver;   ///< that reached it; empty when the file does not say
  AssembledModel model = AssembledModel::exact;  ///< of the law that it solves
  double residual = -1;                          ///< relative; -1 when the file does not say
  std::vector<double> r;                         ///< [rows] [N s]
  std::vector<double> u;                         ///< [rows] [m/s]
  std::vector<double> l;                         ///< of bilateral rows, if any; not read back [N s]
};

/// The run on a problem that came nearest to the law: of those on the cone if there are any.
/// @param runs  at least one
const SolverRun& best_run(const std::vector<SolverRun>& runs);

/// What a run reached on a problem that has W, of three rows a contact or five.
/// @param model  that it solved
Solution solution_of(const ReadyProblem& problem, const SolverRun& run, AssembledModel model);

/// Replaces the file: HDF5, `/solution/r`, `/solution/u` and, where rows are bilateral, `/solution/l` as FCLIB has them, the rest as
/// attributes of the root. docs/solve.md. @throws RunError
void write_solution(const std::filesystem::path& path, const Solution& solution);

/// Reads a file of write_solution, or the solution in an FCLIB file, which is one of the exact law.
/// @throws InputError naming the file and what is wrong
Solution read_solution(const std::filesystem::path& path);

/// Measures velocities against a solution, and impulses where it has meaningful ones.
/// @throws InputError when it is of another law or size
void use_reference(ReadyProblem& problem, const Solution& reference, AssembledModel model);

}  // namespace scree
