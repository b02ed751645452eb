#pragma once
// Options and results of solvers of assembled problems, and the monitor that checks iterates: it
// measures, records, keeps the best, and says when to stop. Every solver is judged by it alone.

#include <chrono>
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
  std::vector<double> guess;  ///< [3 contact_count], any values; empty: zero
  /// u that curves are compared with [3 contact_count]; empty: none
  std::vector<double> reference_velocity;
  /// Impulses of the same [3 contact_count], which need not be the only ones; empty: not known
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
  std::vector<double> r;    ///< best impulses that were checked [3 contact_count]
  int iterations = 0;       ///< done
  long applications = 0;    ///< products with W: a sweep over all its rows counts one, and so does
                            ///< the velocity that a check needs
  long factorizations = 0;  ///< of sparse matrices
  double seconds = 0;
  AssembledResidual residual;  ///< of r
  AssembledStatus status = AssembledStatus::iteration_limit;
  std::string note;  ///< what a user should know, or empty
};

/// Follows one solve.
class AssembledMonitor {
 public:
  /// All must outlive the monitor. @param curve  may be null
  AssembledMonitor(const AssembledProblem& problem, const AssembledOptions& options,
                   std::vector<AssembledCurvePoint>* curve);

  /// Whether an iteration (from 0, the guess) is one to check: every check_every-th, and the last.
  bool due(int iteration) const;
  /// Iterations from this one to the next that is due by its number, at least 1: what a method may
  /// run without asking.
  int until_due(int iteration) const;

  /// Checks the impulses after `iteration` iterations of the current phase: one product with W.
  /// @return whether to stop
  bool check(int iteration, const std::vector<double>& r);
  /// The same for a solver that has u = W r + q at hand.
  bool check(int iteration, const std::vector<double>& r, const std::vector<double>& u);
  /// Both of the above in a loop: checks when due and says whether to stop.
  bool look_if_due(int iteration, const std::vector<double>& r) {
    return due(iteration) && check(iteration, r);
  }

  void count_applications(long count = 1) { result_.applications += count; }
  void count_factorizations(long count = 1) { result_.factorizations += count; }

  /// The result is to be the last impulses that were checked, not those of the least residual:
  /// for methods that solve another law than the one of the residual.
  void keep_last() { keep_last_ = true; }

  /// Ends the solve for a reason other than the monitor's own.
  void fail(AssembledStatus status, std::string note = {});
  /// Whether the problem is shown to have no solution (infeasibility.h), and if so fails with that
  /// status. Costs an interior-point solve when it is asked for the first time.
  bool fail_if_unsolvable();
  /// Appends to the note of the result.
  void note(const std::string& text);

  /// Starts another phase, for solvers that hand over to another: iterations count from 0 again,
  /// and how the last phase ended is forgotten.
  /// @param most         iterations of the phase, at whose end it stops; 0: what is left
  /// @param check_every  iterations between checks in it; 0: that of the options
  /// @return whether there is one: false, and nothing changes, when the solve has converged or is
  ///         out of iterations or time, or has shown that there is no solution
  bool next_phase(int most = 0, int check_every = 0);

  bool stopped() const { return stopped_; }
  AssembledStatus status() const { return result_.status; }
  /// Whether the tolerance was reached.
  bool converged() const { return stopped_ && result_.status == AssembledStatus::converged; }
  bool out_of_time() const;
  double seconds() const;
  /// Residual of the last check.
  const AssembledResidual& last() const { return last_; }
  /// Best impulses so far and their residual.
  const std::vector<double>& best() const { return result_.r; }
  const AssembledResidual& best_residual() const { return result_.residual; }
  /// Contacts whose state changed between the last two checks.
  int state_changes() const { return state_changes_; }
  long applications() const { return result_.applications; }
  /// Impulses and u of the last check.
  const std::vector<double>& last_impulses() const { return last_r_; }
  const std::vector<double>& last_velocity() const { return velocity_; }

  /// The account, complete. Call once, at the end.
  AssembledResult finish();

 private:
  /// Fills in the errors against the reference, if there is one.
  void compare(const std::vector<double>& r, const std::vector<double>& u,
               AssembledCurvePoint& point) const;
  /// Whether a residual is that of a solution.
  bool reached(const AssembledResidual& residual) const;
  /// Whether impulses grow as those of a problem without solution do.
  bool grows(const std::vector<double>& r, const std::vector<double>& u) const;

  const AssembledProblem& problem_;
  const AssembledOptions& options_;
  std::vector<AssembledCurvePoint>* curve_;
  std::chrono::steady_clock::time_point start_;
  std::vector<double> scale_;
  std::vector<double> last_r_, velocity_;
  std::vector<ContactState> state_, last_state_;
  AssembledResidual last_;
  AssembledResult result_;
  std::string failure_;  ///< why the phase ended
  double reference_norm_ = 0;
  int phase_start_ = 0;  ///< iterations of earlier phases
  int phase_limit_ = 0;  ///< iterations of this one
  int check_every_ = 1;
  int state_changes_ = 0;
  bool looked_ = false;
  bool keep_last_ = false;
  bool stopped_ = false;
  bool asked_ = false;       ///< whether there is a solution, which is expensive
  bool unsolvable_ = false;  ///< the answer
};

}  // namespace scree
