#pragma once
// Conjugate projected gradient, for any set of impulses that can be projected on.

#include <string>
#include <vector>

#include "solvers/assembled/assembled_solver.h"

namespace scree {

/// A friction law as a minimization over a set C that stays as it is: of 1/2 r.W r + r.(q + lift)
/// over r in C, contact by contact. Bounds and lifts that belong to the law but depend on its
/// solution are held, and taken anew by renew().
class CpgLaw {
 public:
  virtual ~CpgLaw() = default;
  /// Nearest point of C. @param x  of contact c [3], in place
  virtual void project(int c, double* x) const = 0;
  /// Nearest direction of the tangent cone of C at x. @param v  [3], in place
  virtual void project_on_tangent(int c, const double* x, double* v) const = 0;
  /// Largest change by a projection, relative to an impulse, that is mere rounding: of sets whose
  /// faces are planes that are not along the axes. On curved ones each change is one of direction.
  virtual double rounding() const { return 0; }
  /// What is added to the normal velocity.
  virtual double lift(int /*c*/) const { return 0; }
  /// Takes bounds and lifts from points and velocities [3 contact_count]; points may then be
  /// outside of C.
  virtual void renew(const std::vector<double>& /*r*/, const std::vector<double>& /*u*/) {}
  /// Name of the law where it is not that of the cone, else empty.
  virtual std::string name() const { return {}; }
};

/// Runs from the guess until the monitor stops it or, for a law that is not the cone's, until
/// |x - P_C(x - g)| is below the tolerance times |q| with bounds and lifts of the moment: a stall
/// with a note, as the residual is that of another law. See cpg.cpp for the method.
/// @param law  of the problem in x = S r (ScaledProblem), which has the same mu
void run_cpg(const AssembledProblem& problem, const AssembledOptions& options, CpgLaw& law,
             AssembledMonitor& monitor);

}  // namespace scree
