#pragma once
// How Newton's method on contact functions ends other than by the monitor, wherever it runs.

#include <cmath>
#include <string>
#include <vector>

#include "solvers/assembled/assembled_monitor.h"

namespace scree {

/// |D^-1/2 q|, which |D^1/2 F| is measured by. @param scale  D, of contact_scales
inline double scaled_load(const AssembledProblem& p, const std::vector<double>& scale) {
  double sum = 0;
  for (std::size_t k = 0; k < p.q.size(); ++k) sum += p.q[k] * p.q[k] / scale[k / 3];
  return std::sqrt(sum);
}

/// Another law than the cone's holds, which the residual does not say.
inline void fail_as_solved(AssembledMonitor& monitor, const std::string& law) {
  monitor.fail(AssembledStatus::stalled, "solved with " + law + ", not the cone");
}

/// No point of the step is lower. @param is_trapped  nor is one along the gradient
inline void fail_as_stalled(AssembledMonitor& monitor, bool is_trapped) {
  monitor.fail(AssembledStatus::stalled,
               is_trapped ? "trapped at a kink or local minimum of the merit function"
                          : "no descent of the merit function along the Newton step");
}

}  // namespace scree
