#pragma once
// What scree solve prints and writes about solver runs.

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
  std::optional<SolverRun>
      reference;  ///< whose answer velocity errors are against, see find_reference
  std::vector<SolverRun> runs;
};

/// A table with one line a solver: iterations, applications, seconds, residuals, objective, status.
std::string to_table(const ProblemReport& report);

/// For several problems: how many each solver solved, and the seconds they took it.
std::string to_summary(const std::vector<ProblemReport>& reports);

/// @param options  what the solvers were given
nlohmann::json to_json(const std::vector<ProblemReport>& reports, const AssembledOptions& options);

/// One line a problem and solver.
std::string results_csv(const std::vector<ProblemReport>& reports);

/// The objective [J] that gaps are measured to: the least that a run on the problem ended with.
/// Only runs that converged on the cone count, and the reference where it is as accurate as those.
/// Infinite when there is none. Of the convex model alone is it a minimum.
double least_objective(const ProblemReport& report);

/// One line a look. @param least_objective  that gaps are measured to; not finite: no gaps
std::string curve_csv(const SolverRun& run, double least_objective);

/// Profiles of the solvers of the first report over all reports, at least one. Cost is time by the
/// clock, or products with W.
PerformanceProfile seconds_profile(const std::vector<ProblemReport>& reports);
PerformanceProfile applications_profile(const std::vector<ProblemReport>& reports);

/// Writes results.csv, results.json, curves/<problem>_<solver>.csv and, for several problems,
/// profile_seconds.csv and profile_applications.csv below a folder.
/// @throws RunError
void write_reports(const std::filesystem::path& folder, const std::vector<ProblemReport>& reports,
                   const AssembledOptions& options);

}  // namespace scree
