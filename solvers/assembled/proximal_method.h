#pragma once
// The proximal point loop, for proximal and for the solvers that build on it.

#include <functional>

#include "solvers/assembled/assembled_solver.h"

namespace scree {

struct ProximalSettings {
  double first_weight = 1e-2;  ///< a of the first outer iteration, in units of D
  double least_weight = 1e-8;
  double largest_weight = 10;
  bool adapts = true;  ///< whether the weight follows what the method can do
  /// Most that the weight grows by in one failure: one after another grow it by 2, 4, 8 and so on.
  double largest_growth = 2;
  bool newton = true;  ///< whether inner problems go to Newton first, or to Gauss-Seidel alone
  int newton_iterations = 30;
  int sweeps = 100;  ///< at most, of Gauss-Seidel where Newton fails or is not asked
  /// Failures of the method that goes first, before it ever solved an inner problem, after which it
  /// stalls; 0: it never does.
  int most_opening_failures = 0;
  /// Outer iterations without half the least residual after which it stalls; 0: it never does.
  int patience = 0;
};

/// What solves inner problems: each runs from the guess of the options until its monitor stops it.
struct ProximalMethods {
  using Run =
      std::function<void(const AssembledProblem&, const AssembledOptions&, AssembledMonitor&)>;
  Run newton;
  Run sweeps;  ///< of nonlinear Gauss-Seidel
};

/// Those of the host, with factorizations.
ProximalMethods host_proximal_methods();

/// Runs from the guess until the monitor stops it, or stalls out of patience.
/// See proximal.cpp for the method.
/// @return  false when it stalled after most_opening_failures
bool run_proximal(const AssembledProblem& problem, const AssembledOptions& options,
                  const ProximalSettings& settings, AssembledMonitor& monitor,
                  const ProximalMethods& methods = host_proximal_methods());

}  // namespace scree
