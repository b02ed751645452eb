#pragma once
// Follows one solve of a problem with rolling friction: checks iterates, has an account kept,
// and says when to stop, as AssembledMonitor does for three rows a contact.

#include <string>
#include <vector>

#include "solvers/assembled/solve_account.h"
#include "solvers/rolling/rolling_measures.h"

namespace scree {

class RollingMonitor {
 public:
  /// All must outlive the monitor. @param curve  may be null
  RollingMonitor(const RollingProblem& problem, const std::vector<double>& scales,
                 const AssembledOptions& options, std::vector<AssembledCurvePoint>* curve);

  /// Checks impulses x = S r, when it is time to, and says whether the phase is over.
  bool over(const std::vector<double>& x);
  /// An iteration is done that took so many products with W.
  void count(int products = 1);
  /// Whether the last call of over() looked.
  bool looked() const { return looked_; }

  void count_factorizations(int count) { account_.count_factorizations(count); }

  /// Starts a phase of so many iterations. @return whether there is one: not after the end
  /// @param check_every  iterations between looks
  bool next_phase(int most, int check_every);
  bool stopped() const { return stopped_; }
  bool out_of_time() const { return account_.out_of_time(); }

  /// Best impulses so far as x = S r.
  std::vector<double> best() const { return scaled_impulses(account_.best()); }
  /// S r
  std::vector<double> scaled_impulses(std::vector<double> r) const;

  void fail(AssembledStatus status, const std::string& note);
  void note(const std::string& text) { account_.note(text); }
  /// The account, complete. Call once, at the end.
  AssembledResult finish() { return account_.finish(); }

 private:
  void look(const std::vector<double>& x);

  const RollingProblem& problem_;
  const std::vector<double>& scales_;
  const AssembledOptions& options_;
  SolveAccount account_;
  std::vector<ContactState> state_;
  int phase_end_ = 0;
  int check_every_ = 1;
  bool looked_ = false;
  bool stopped_ = false;
};

}  // namespace scree
