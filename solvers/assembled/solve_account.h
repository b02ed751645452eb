#pragma once
// The account of one solve, whatever the rows of a contact. Monitors give it what they measure.

#include <chrono>
#include <string>
#include <vector>

#include "solvers/assembled/assembled_result.h"

namespace scree {

/// What a solve has found and spent so far.
class SolveAccount {
 public:
  /// Starts the clock. Options and curve must outlive the account.
  /// @param q      of the problem [rows]
  /// @param curve  may be null
  SolveAccount(const std::vector<double>& q, const AssembledOptions& options,
               std::vector<AssembledCurvePoint>* curve);

  /// Takes a check after iterations() iterations: keeps the impulses if they are the best, and adds
  /// a point to the curve.
  /// @param r, u      impulses and W r + q [rows]
  /// @param residual  of r, by all measures
  /// @param state     what contacts do [contact_count]
  /// @return          whether all is finite; if not, nothing but last() changes
  bool take(const std::vector<double>& r, const std::vector<double>& u,
            const AssembledResidual& residual, const std::vector<ContactState>& state);
  /// The best impulses are those of the last check, whatever their residual.
  void keep_last() { keep_last_ = true; }

  void set_iterations(int count) { result_.iterations = count; }
  void count_applications(long count) { result_.applications += count; }
  void count_factorizations(long count) { result_.factorizations += count; }
  void set_status(AssembledStatus status) { result_.status = status; }
  /// Appends to the note of the result; nothing if the text is empty.
  void note(const std::string& text);

  int iterations() const { return result_.iterations; }
  long applications() const { return result_.applications; }
  AssembledStatus status() const { return result_.status; }
  double seconds() const;
  bool out_of_time() const { return options_.max_seconds > 0 && seconds() >= options_.max_seconds; }
  /// Residual of the last check.
  const AssembledResidual& last() const { return last_; }
  /// Zero before the first check.
  const std::vector<double>& best() const { return result_.r; }
  const AssembledResidual& best_residual() const { return result_.residual; }
  /// Contacts whose state changed between the last two checks.
  int state_changes() const { return state_changes_; }

  /// Complete, with the seconds. Call once, at the end.
  AssembledResult finish();

 private:
  /// Fills in the errors against the reference, if there is one.
  void compare(const std::vector<double>& r, const std::vector<double>& u,
               AssembledCurvePoint& point) const;

  const AssembledOptions& options_;
  std::vector<AssembledCurvePoint>* curve_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::vector<ContactState> last_state_;
  AssembledResidual last_;
  AssembledResult result_;
  double reference_norm_ = 0;
  int state_changes_ = 0;
  bool has_best_ = false;
  bool keep_last_ = false;
};

}  // namespace scree
