#pragma once
// Newton's method on contact functions, for newton and for the solvers that build on it.

#include <functional>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/contact_function.h"

namespace scree {

/// The equations of another law than the cone's, contact by contact.
struct NewtonLaw {
  std::string name;  ///< of the law; empty: none, and contact_function() of the model holds
  /// @param c, r, u  contact, its impulse and its velocity [3]
  std::function<ContactFunction(int c, const double* r, const double* u)> function;
};

struct NewtonSettings {
  /// Added to W in the Jacobian alone, in units of contact_scales: makes it regular where contacts
  /// are redundant. Steps are then no longer exactly Newton's.
  double shift = 0;
  int trials = 12;              ///< halvings of a step before giving up
  double least_descent = 1e-4;  ///< Armijo's constant
  NewtonLaw law;
};

/// Runs from the guess until the monitor stops it, or fails it: as `singular`; as `stalled` where
/// no point of a step is lower, with a note that says whether the gradient of the merit function
/// leads down (the step was wrong) or not either (trapped, at a kink or local minimum); as
/// `stalled`, too, where another law is solved, to the tolerance times |q| in the metric of
/// contact_scales.
/// @throws nothing; see newton.cpp for the method
void run_newton(const AssembledProblem& problem, const AssembledOptions& options,
                const NewtonSettings& settings, AssembledMonitor& monitor);

}  // namespace scree
