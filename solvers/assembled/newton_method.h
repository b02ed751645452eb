#pragma once
// Newton's method on contact functions, for newton and for the solvers that build on it.

#include "solvers/assembled/assembled_solver.h"

namespace scree {

struct NewtonSettings {
  /// Added to W in the Jacobian alone, in units of contact_scales: makes it regular where contacts
  /// are redundant. Steps are then no longer exactly Newton's.
  double shift = 0;
  int trials = 12;              ///< halvings of a step before giving up
  double least_descent = 1e-4;  ///< Armijo's constant
};

/// Runs from the guess until the monitor stops it, or fails it as `singular` or `stalled`.
/// @throws nothing; see newton.cpp for the method
void run_newton(const AssembledProblem& problem, const AssembledOptions& options,
                const NewtonSettings& settings, AssembledMonitor& monitor);

}  // namespace scree
