#pragma once
// What the solver of a benchmark moves through memory, against the speed of copies.

#include "host/cli/bench/figures.h"
#include "host/scene.h"
#include "host/world.h"

namespace scree {

/// Memory traffic of a solver over a row of steps.
struct Bandwidth {
  double least_bytes = 0;  ///< that one application moves; 0: not counted for this solver
  double bytes_per_s = 0;  ///< these bytes, all applications, over the time of the solver
  double of_copy = 0;      ///< over the speed of copies

  bool is_counted() const { return least_bytes > 0; }
};

/// @param copy  copy_bandwidth() of the backend [bytes/s]
Bandwidth bandwidth_of(const StepFigures& figures, const SolverSettings& solver,
                       const WorldOptions& options, double copy);

/// Entries of a result; none when nothing is counted.
Json to_json(const Bandwidth& bandwidth);

}  // namespace scree
