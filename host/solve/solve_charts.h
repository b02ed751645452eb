#pragma once
// Convergence curves and performance profiles of solver runs as charts.

#include <filesystem>
#include <string>
#include <vector>

#include "host/plot/figure.h"
#include "host/solve/solve_report.h"

namespace scree {

/// Curves of all solvers on one problem: residual, distance of the objective from least_objective()
/// where that is known, error of the velocity where there is a reference, and contacts that changed
/// state, each over iterations, applications and seconds.
Figure curves_figure(const ProblemReport& report);

/// Shares of problems solved, as steps, up to ten times the best at least. @param cost  what the
/// ratios are of, for instance "seconds"
Figure profile_figure(const PerformanceProfile& profile, const std::string& cost);

/// Writes curves_<problem>.png into a folder; nothing in a build that cannot draw. @throws RunError
void write_curves_chart(const std::filesystem::path& folder, const ProblemReport& report);

/// Writes profile_seconds.png and profile_applications.png of several problems into a folder.
/// @return empty; or, in a build that cannot draw, a sentence that says so and
///         where the numbers are
/// @throws RunError
std::string write_profile_charts(const std::filesystem::path& folder,
                                 const std::vector<ProblemReport>& reports);

}  // namespace scree
