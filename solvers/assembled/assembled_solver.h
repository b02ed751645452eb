#pragma once
// What every solver of assembled problems is: something that takes W, q and mu and a guess, and
// returns impulses with an account of how good they are.
//
// To add one: a file <name>.cpp here that defines make_assembled_<name>(), or <name>.inst.h when it
// runs on every backend (backend_solver.h), and its line in solver_list.inc. It derives from
// AssembledSolver and hands its iterates to the monitor.

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/assembled/assembled_monitor.h"

namespace scree {

/// What a solver is, for tables, and what it takes when the options leave it open.
struct AssembledTraits {
  std::string name;
  std::string description;  ///< one line: method and source
  /// Whether run() solves the exact model. If not, it is asked for convex problems only, and the
  /// exact model is reached by the De Saxce fixed point around it.
  bool exact = true;
  /// Whether run() solves the convex model.
  bool convex = true;
  int default_iterations = 10000;  ///< when AssembledOptions::max_iterations is 0
  int default_check_every = 10;    ///< when AssembledOptions::check_every is 0
  /// Set of tangential impulses that a contact may have. Where it is not the disk of the cone, the
  /// method solves another law: its residual, which is that of the cone, does not go to zero.
  std::string friction = "cone";
  bool relaxes = false;    ///< whether AssembledOptions::relaxation changes what it does
  bool holds_rows = true;  ///< whether it solves problems with bilateral rows (held_rows.h)
};

class AssembledSolver {
 public:
  virtual ~AssembledSolver() = default;
  virtual AssembledTraits traits() const = 0;

  /// Solves from the guess of the options. For the convex model an unsymmetric W is replaced by its
  /// symmetric part, which the result notes; residuals and objective are those of that problem.
  /// Never throws because a problem is hard: what happened is the status.
  /// @param curve  when given, every check is appended
  /// @throws AssembledError when sizes disagree, an option is out of range, or rows are held that the
  ///         method does not know
  AssembledResult solve(const AssembledProblem& problem, const AssembledOptions& options,
                        std::vector<AssembledCurvePoint>* curve = nullptr) const;

  /// The method itself, for solve() and for solvers built of others. Iterates go to the monitor; it
  /// returns when the monitor says stop, or after monitor.fail().
  /// @param options  guess has its full size, max_iterations and check_every are positive
  virtual void run(const AssembledProblem& problem, const AssembledOptions& options,
                   AssembledMonitor& monitor) const = 0;
};

/// Sizes that disagree, or an option outside its range.
class AssembledError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where a solver computes. On a device W, q, mu and all vectors of a method are in its memory; a
/// check brings impulses and velocities to the host, which measures them.
struct AssembledTarget {
  bool cuda = false;
  /// Of the CPU, for solvers that run on backends; 0: all. With one, times of all solvers are of
  /// the same means.
  int threads = 1;
};

/// Makes a solver by its registered name.
/// @throws AssembledError naming the known solvers when the name is none of them, or has no form
///         for CUDA; or when this build has no CUDA. DeviceError when there is no device
std::unique_ptr<AssembledSolver> make_assembled_solver(const std::string& name,
                                                       const AssembledTarget& target = {});

/// Names that make_assembled_solver knows: all, or those that also run on CUDA.
std::vector<std::string> assembled_solver_names(bool cuda = false);

}  // namespace scree
