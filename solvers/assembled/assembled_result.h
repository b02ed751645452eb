#pragma once
// What a solve of a problem given by W, q and mu is asked for, and what it returns, whatever the
// rows of a contact: 3, or 5 with rolling friction. [rows] is their number over all contacts.

#include <string>
#include <vector>

#include "solvers/assembled/assembled_measures.h"

namespace scree {

struct AssembledOptions {
  AssembledModel model = AssembledModel::exact;
  double tolerance = 1e-8;  ///< on the measure below, >= 0; 0 runs all iterations
  AssembledMeasure measure = AssembledMeasure::relative;
  int max_iterations = 0;  ///< of the method, outer ones where there are two kinds; 0: its own
  int check_every = 0;     ///< iterations between checks; 0: the method's own
  double max_seconds = 0;  ///< by the clock; 0: no limit
  double relaxation = 0;   ///< of methods that have one, in (0, 2); 0: the method's own
  /// Whether checks find problems without solution, see infeasibility.h.
  bool tell_unsolvable = true;
  /// Set by AssembledSolver::solve() where the tolerance is not on the relative residual: what has
  /// to be reached by that measure. Methods aim at `tolerance`, which is relative for them.
  double goal = 0;
  std::vector<double> guess;  ///< [rows], any values; empty: zero
  /// u that curves are compared with [rows]; empty: none
  std::vector<double> reference_velocity;
  /// Impulses of the same [rows], which need not be the only ones; empty: not known
  std::vector<double> reference_impulse;
};

enum class AssembledStatus {
  converged,        ///< reached the tolerance
  iteration_limit,  ///< stopped at max_iterations
  time_limit,       ///< stopped at max_seconds
  stalled,          ///< the method cannot get further: no descent, or nothing moves
  diverged,         ///< impulses grew without bound or are not finite
  singular,         ///< a linear system could not be solved
  no_solution,      ///< none exists, see AssembledResult::note
  unsupported       ///< the method does not know this model or problem
};

/// "converged", "iteration limit", ...
const char* to_string(AssembledStatus status);

/// One check of an iterate.
struct AssembledCurvePoint {
  int iteration = 0;
  long applications = 0;
  double seconds = 0;
  AssembledResidual residual;
  double velocity_error = -1;  ///< |u - u*| / max(|u*|, 1e-3 |q|); -1 without a reference
  /// 1/2 (r - r*).(u - u*): the kinetic energy that the bodies would have with the difference
  /// between their velocities and those of the reference [J]; -1 without its impulses. Where r is
  /// not unique, it is good to about 1e-16 times that of the whole impulses.
  double kinetic_error = -1;
  int state_changes = 0;  ///< contacts whose open/stick/slip state changed since the last check
};

struct AssembledResult {
  std::vector<double> r;    ///< best impulses that were checked [rows]
  int iterations = 0;       ///< done
  long applications = 0;    ///< products with W: a sweep over all its rows counts one, and so does
                            ///< the velocity that a check needs
  long factorizations = 0;  ///< of sparse matrices
  double seconds = 0;
  AssembledResidual residual;  ///< of r
  AssembledStatus status = AssembledStatus::iteration_limit;
  std::string note;  ///< what a user should know, or empty
};

}  // namespace scree
