#pragma once
// What scree solve prints and writes about solver runs.

#include <cstdio>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/solve/performance_profile.h"
#include "host/solve/solve_problem.h"

namespace scree {

/// Solvers on one problem.
struct ProblemReport {
  std::string name;
  std::filesystem::path file;
  int contact_count = 0;
  int dimension = 3;
  double asymmetry = 0;
  /// Whose answer velocity errors are against, see find_reference.
  std::optional<SolverRun> reference;
  std::vector<SolverRun> runs;
  int bilateral_rows = 0;
  int dependent_rows = 0;  ///< of these, on others of them
};

/// A file of a folder that could not be read or solved.
struct SkippedProblem {
  std::filesystem::path file;
  std::string reason;
};

/// A table with one line a solver: iterations, applications, seconds, residuals, objective, status.
std::string to_table(const ProblemReport& report);

/// For several problems: how many each solver solved, and the seconds they took it.
std::string to_summary(const std::vector<ProblemReport>& reports);

/// @param options  what the solvers were given
nlohmann::json to_json(const std::vector<ProblemReport>& reports,
                       const std::vector<SkippedProblem>& skipped, const AssembledOptions& options);

/// "relative", "absolute" or "unit-free": the words of the command line.
const char* to_string(AssembledMeasure measure);

/// Columns of results.csv, and the lines of one problem, one a solver.
std::string results_header();
std::string results_lines(const ProblemReport& report);

/// The objective [J] that gaps are measured to: the least that a run on the problem ended with.
/// Only runs that converged on the cone count, and the reference where it is as accurate as those.
/// Infinite when there is none. Of the convex model alone is it a minimum.
double least_objective(const ProblemReport& report);

/// One line a check. @param least_objective  that gaps are measured to; not finite: no gaps
std::string curve_csv(const SolverRun& run, double least_objective);

/// Profiles of the solvers over all reports, at least one. Cost is time by the clock,
/// or products with W.
PerformanceProfile seconds_profile(const std::vector<ProblemReport>& reports);
PerformanceProfile applications_profile(const std::vector<ProblemReport>& reports);

/// results.csv, curves and results.json below a folder, problem by problem: what is done stays when
/// the program ends before its time.
class ReportWriter {
 public:
  /// Starts results.csv. @throws RunError
  explicit ReportWriter(std::filesystem::path folder);
  ~ReportWriter();
  ReportWriter(const ReportWriter&) = delete;
  ReportWriter& operator=(const ReportWriter&) = delete;

  /// Appends the lines of a problem to results.csv and writes curves/<problem>_<solver>.csv.
  /// @throws RunError
  void add(const ProblemReport& report);

  /// Writes results.json and, for several problems, profile_seconds.csv and
  /// profile_applications.csv. @throws RunError
  void finish(const std::vector<ProblemReport>& reports, const std::vector<SkippedProblem>& skipped,
              const AssembledOptions& options);

 private:
  void append(const std::string& text);

  std::filesystem::path folder_;
  std::FILE* results_ = nullptr;
};

}  // namespace scree
