#pragma once
// Figures of a row of time steps: what every benchmark reports.

#include <cstddef>
#include <string>
#include <vector>

#include "host/cli/bench/record.h"
#include "host/world.h"

namespace scree {

struct Spread {
  double min = 0, median = 0, mean = 0, max = 0;
};

struct StageSpread {
  const char* name;
  Spread ms;
};

/// Means over the steps, but the worst of residuals and penetrations.
struct StepFigures {
  int steps = 0;
  int bodies = 0;
  double contacts = 0;
  double iterations = 0;
  double applications = 0;
  double residual_rms = 0;       ///< [m/s]
  double residual_relative = 0;  ///< [v*]
  double max_penetration = 0;    ///< [m]
  int not_converged = 0;         ///< steps
  std::vector<StageSpread> stages;
  double contact_iterations_per_s = 0;  ///< contacts * applications over the time of the solver
  double body_seconds_per_s = 0;        ///< simulated, over the time of whole steps
  std::size_t peak_memory = 0;          ///< [bytes]

  const Spread& ms(const std::string& stage) const;
  double bytes_per_body() const { return static_cast<double>(peak_memory) / bodies; }
};

/// @param reports  one or more
StepFigures figures_of(const std::vector<StepReport>& reports, double time_step,
                       std::size_t peak_memory);

/// @param has_contacts  else without what a solver of contacts did
Json to_json(const StepFigures& figures, bool has_contacts = true);

}  // namespace scree
