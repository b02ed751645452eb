#pragma once
// scree run: simulates a scene and writes its output directory.

#include "host/cli/options.h"

namespace scree {

struct RunOptions {
  RunTarget target;
  std::filesystem::path out;               ///< empty: out/<scene name>
  std::int64_t steps = -1;                 ///< -1: as many as the scene's duration takes
  std::vector<std::int64_t> dump_problem;  ///< steps whose contact problems are written
  bool resume = false;
  bool force = false;
  bool quiet = false;
  bool require_convergence = false;
  std::vector<std::string> command_line;
};

/// Processes that a launcher of MPI started together make one run, see mpi_ranks().
/// @return exit code: 0 done, or ended cleanly after an interrupt
/// @throws InputError, RunError; also when steps did not converge that were required to
int run_scene(const RunOptions& options);

}  // namespace scree
