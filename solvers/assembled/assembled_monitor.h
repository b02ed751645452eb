#pragma once
// The monitor that checks iterates of solvers of assembled problems: it measures, has an account
// kept, and says when to stop. Every solver is judged by it alone.

#include <string>
#include <vector>

#include "solvers/assembled/assembled_problem.h"
#include "solvers/assembled/solve_account.h"

namespace scree {

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

  void count_applications(long count = 1) { account_.count_applications(count); }
  void count_factorizations(long count = 1) { account_.count_factorizations(count); }

  /// The result is to be the last impulses that were checked, not those of the least residual:
  /// for methods that solve another law than the one of the residual.
  void keep_last() { account_.keep_last(); }

  /// Ends the solve for a reason other than the monitor's own.
  void fail(AssembledStatus status, std::string note = {});
  /// Whether the problem is shown to have no solution (infeasibility.h), and if so fails with that
  /// status. Costs an interior-point solve when it is asked for the first time.
  bool fail_if_unsolvable();
  /// Appends to the note of the result.
  void note(const std::string& text) { account_.note(text); }

  /// Starts another phase, for solvers that hand over to another: iterations count from 0 again,
  /// and how the last phase ended is forgotten.
  /// @param most         iterations of the phase, at whose end it stops; 0: what is left
  /// @param check_every  iterations between checks in it; 0: that of the options
  /// @return whether there is one: false, and nothing changes, when the solve has converged or is
  ///         out of iterations or time, or has shown that there is no solution
  bool next_phase(int most = 0, int check_every = 0);

  bool stopped() const { return stopped_; }
  AssembledStatus status() const { return account_.status(); }
  /// Whether the tolerance was reached.
  bool converged() const { return stopped_ && status() == AssembledStatus::converged; }
  bool out_of_time() const { return account_.out_of_time(); }
  double seconds() const { return account_.seconds(); }
  /// Residual of the last check.
  const AssembledResidual& last() const { return account_.last(); }
  /// Best impulses so far and their residual.
  const std::vector<double>& best() const { return account_.best(); }
  const AssembledResidual& best_residual() const { return account_.best_residual(); }
  /// Contacts whose state changed between the last two checks.
  int state_changes() const { return account_.state_changes(); }
  long applications() const { return account_.applications(); }
  /// Impulses and u of the last check.
  const std::vector<double>& last_impulses() const { return last_r_; }
  const std::vector<double>& last_velocity() const { return velocity_; }

  /// The account, complete. Call once, at the end.
  AssembledResult finish();

 private:
  /// Whether a residual is that of a solution.
  bool reached(const AssembledResidual& residual) const;
  /// Whether impulses grow as those of a problem without solution do.
  bool grows(const std::vector<double>& r, const std::vector<double>& u) const;

  const AssembledProblem& problem_;
  const AssembledOptions& options_;
  SolveAccount account_;
  std::vector<double> scale_;
  std::vector<double> last_r_, velocity_;
  std::vector<ContactState> state_;
  std::string failure_;  ///< why the phase ended
  int phase_start_ = 0;  ///< iterations of earlier phases
  int phase_limit_ = 0;  ///< iterations of this one
  int check_every_ = 1;
  bool stopped_ = false;
  bool asked_ = false;       ///< whether there is a solution, which is expensive
  bool unsolvable_ = false;  ///< the answer
};

}  // namespace scree
