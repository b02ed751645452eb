#pragma once
// scree solve: solvers on stored contact problems, one file or a folder of them.

#include <filesystem>
#include <string>

#include "host/cli/options.h"

namespace scree {

struct SolveOptions {
  std::filesystem::path problem;     ///< file, or folder with *.hdf5 and *.h5 files
  std::string solver = "auto";       ///< name, comma-separated names, or all
  std::string model = "exact";       ///< convex or exact
  double tolerance = 1e-8;           ///< on the measure
  std::string measure = "relative";  ///< relative, absolute or unit-free
  long long max_iterations = 0;      ///< 0: each solver's own
  double max_seconds = 100;          ///< per solver and problem; 0: no limit
  int check_every = 0;               ///< 0: each solver's own
  double relaxation = 0;             ///< 0: each solver's own
  bool warm_start = false;           ///< start from the guess in the file
  /// What velocity errors are against: a solver, a file with a solution, or a folder of them;
  /// empty: the solution in the problem's file
  std::string reference;
  std::filesystem::path solution;  ///< file to write, or folder for those of several problems
  bool matrix_free = false;        ///< the solvers of simulation steps, on the bodies
  RunTarget target;                ///< backend, precision and threads
  std::filesystem::path out;       ///< empty: nothing is written
  bool force = false;
  bool json = false;
};

/// @return exit code 0, whether or not solvers reached the tolerance: that is the table's to say;
///         1 when files of a folder were skipped
/// @throws InputError, RunError
int solve_problems(const SolveOptions& options);

}  // namespace scree
