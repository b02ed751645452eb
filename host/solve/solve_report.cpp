#include "host/solve/solve_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/version.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

/// Whether the residual is that of the law which the solver solves.
bool has_cone(const SolverRun& run) { return run.friction == "cone"; }

bool solved(const SolverRun& run) { return run.result.status == AssembledStatus::converged; }

/// Text within quotes where it holds what separates cells.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// Solvers that ran on any of the problems: `all` means others where there is rolling friction.
std::vector<std::string> solvers_of(const std::vector<ProblemReport>& reports) {
  std::vector<std::string> names;
  for (const ProblemReport& report : reports)
    for (const SolverRun& run : report.runs)
      if (std::find(names.begin(), names.end(), run.solver) == names.end())
        names.push_back(run.solver);
  return names;
}

/// What a solver did on a problem; null: it did not run there.
const SolverRun* run_of(const ProblemReport& report, const std::string& solver) {
  const auto run = std::find_if(report.runs.begin(), report.runs.end(),
                                [&](const SolverRun& r) { return r.solver == solver; });
  return run == report.runs.end() ? nullptr : &*run;
}

template <class Cost>
PerformanceProfile profile_of(const std::vector<ProblemReport>& reports, Cost cost) {
  ProfileCosts costs;
  costs.solvers = solvers_of(reports);
  for (const ProblemReport& report : reports) {
    costs.cost.emplace_back();
    for (const std::string& solver : costs.solvers) {
      const SolverRun* run = run_of(report, solver);
      costs.cost.back().push_back(run != nullptr && solved(*run)
                                      ? cost(run->result)
                                      : std::numeric_limits<double>::infinity());
    }
  }
  return performance_profile(costs);
}

nlohmann::json json_of(const SolverRun& run) {
  const AssembledResult& r = run.result;
  return {{"solver", run.solver},
          {"friction", run.friction},
          {"backend", run.backend},
          {"status", to_string(r.status)},
          {"converged", solved(run)},
          {"iterations", r.iterations},
          {"applications", r.applications},
          {"factorizations", r.factorizations},
          {"seconds", r.seconds},
          {"residual", r.residual.relative},
          {"residual_absolute", r.residual.absolute},
          {"residual_to_largest", r.residual.to_largest},
          {"residual_unit_free", r.residual.unit_free},
          {"objective", r.residual.objective},
          {"note", r.note}};
}

}  // namespace

double least_objective(const ProblemReport& report) {
  double least = std::numeric_limits<double>::infinity(), accuracy = 0;
  for (const SolverRun& run : report.runs) {
    if (!solved(run) || !has_cone(run)) continue;
    least = std::min(least, run.result.residual.objective);
    accuracy = std::max(accuracy, run.result.residual.relative);
  }
  if (report.reference.has_value() && has_cone(*report.reference)) {
    const AssembledResult& r = report.reference->result;
    if (solved(*report.reference) || r.residual.relative <= accuracy)
      least = std::min(least, r.residual.objective);
  }
  return least;
}

PerformanceProfile seconds_profile(const std::vector<ProblemReport>& reports) {
  return profile_of(reports, [](const AssembledResult& r) { return r.seconds; });
}

PerformanceProfile applications_profile(const std::vector<ProblemReport>& reports) {
  return profile_of(reports,
                    [](const AssembledResult& r) { return static_cast<double>(r.applications); });
}

std::string to_table(const ProblemReport& report) {
  std::string text = fmt::format("{}: {} contacts ", report.name, report.contact_count);
  text +=
      report.dimension == 5 ? "with rolling friction" : fmt::format("in {}-D", report.dimension);
  if (report.bilateral_rows > 0) text += fmt::format(", {} bilateral rows", report.bilateral_rows);
  if (report.dependent_rows > 0)
    text += fmt::format(" ({} depend on others)", report.dependent_rows);
  if (report.asymmetry > 1e-12) text += fmt::format(", W unsymmetric by {:.1e}", report.asymmetry);
  if (!report.runs.empty()) text += ", on " + report.runs.front().backend;
  if (report.reference.has_value())
    text += fmt::format(", velocities against {} (residual {:.1e}, {})", report.reference->solver,
                        report.reference->result.residual.relative,
                        to_string(report.reference->result.status));
  text +=
      fmt::format("\n{:<21} {:>10} {:>12} {:>10} {:>9} {:>9} {:>16}  {}\n", "solver", "iterations",
                  "applications", "seconds", "residual", "unit-free", "objective", "status");
  for (const SolverRun& run : report.runs) {
    const AssembledResult& r = run.result;
    text += fmt::format("{:<21} {:>10} {:>12} {:>10.4f} {:>9.2e} {:>9.2e} {:>16.9e}  {}{}{}\n",
                        run.solver, r.iterations, r.applications, r.seconds, r.residual.relative,
                        r.residual.unit_free, r.residual.objective,
                        has_cone(run) ? "" : run.friction + " friction, ", to_string(r.status),
                        r.note.empty() ? "" : ": " + r.note);
  }
  return text;
}

std::string to_summary(const std::vector<ProblemReport>& reports) {
  std::string text = fmt::format("{} problems\n{:<21} {:>10} {:>12}\n", reports.size(), "solver",
                                 "solved", "seconds");
  for (const std::string& solver : solvers_of(reports)) {
    int count = 0;
    double seconds = 0;
    for (const ProblemReport& report : reports)
      if (const SolverRun* run = run_of(report, solver); run != nullptr) {
        count += solved(*run);
        seconds += run->result.seconds;
      }
    text += fmt::format("{:<21} {:>10} {:>12.4f}\n", solver, count, seconds);
  }
  return text;
}

const char* to_string(AssembledMeasure measure) {
  switch (measure) {
    case AssembledMeasure::absolute:
      return "absolute";
    case AssembledMeasure::unit_free:
      return "unit-free";
    case AssembledMeasure::relative:
      break;
  }
  return "relative";
}

nlohmann::json to_json(const std::vector<ProblemReport>& reports,
                       const std::vector<SkippedProblem>& skipped,
                       const AssembledOptions& options) {
  nlohmann::json problems = nlohmann::json::array();
  for (const ProblemReport& report : reports) {
    nlohmann::json runs = nlohmann::json::array();
    for (const SolverRun& run : report.runs) runs.push_back(json_of(run));
    problems.push_back({{"problem", report.name},
                        {"file", report.file.string()},
                        {"contacts", report.contact_count},
                        {"dimension", report.dimension},
                        {"asymmetry", report.asymmetry},
                        {"bilateral_rows", report.bilateral_rows},
                        {"dependent_rows", report.dependent_rows},
                        {"runs", runs}});
    if (report.reference.has_value()) problems.back()["reference"] = json_of(*report.reference);
  }
  nlohmann::json without = nlohmann::json::array();
  for (const SkippedProblem& s : skipped)
    without.push_back({{"file", s.file.string()}, {"reason", s.reason}});
  return {{"version", version()},
          {"commit", commit()},
          {"model", name_of(options.model)},
          {"tolerance", options.tolerance},
          {"measure", to_string(options.measure)},
          {"max_iterations", options.max_iterations},
          {"max_seconds", options.max_seconds},
          {"problems", problems},
          {"skipped", without}};
}

std::string results_header() {
  return "problem,contacts,dimension,solver,status,iterations,applications,factorizations,seconds,"
         "residual,residual_absolute,residual_to_largest,residual_unit_free,objective,friction,"
         "note,backend\n";
}

std::string results_lines(const ProblemReport& report) {
  std::string text;
  for (const SolverRun& run : report.runs) {
    const AssembledResult& r = run.result;
    text += fmt::format(
        "{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.15g},{},{},{}\n",
        cell(report.name), report.contact_count, report.dimension, run.solver, to_string(r.status),
        r.iterations, r.applications, r.factorizations, r.seconds, r.residual.relative,
        r.residual.absolute, r.residual.to_largest, r.residual.unit_free, r.residual.objective,
        cell(run.friction), cell(r.note), run.backend);
  }
  return text;
}

std::string curve_csv(const SolverRun& run, double least_objective) {
  std::string text =
      "iteration,applications,seconds,residual,residual_unit_free,objective,objective_gap,"
      "velocity_error,kinetic_error_J,state_changes\n";
  for (const AssembledCurvePoint& p : run.curve) {
    const std::string gap = std::isfinite(least_objective)
                                ? fmt::format("{:.9g}", p.residual.objective - least_objective)
                                : "";
    const auto error = [](double e) { return e < 0 ? "" : fmt::format("{:.6g}", e); };
    text +=
        fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.15g},{},{},{},{}\n", p.iteration, p.applications,
                    p.seconds, p.residual.relative, p.residual.unit_free, p.residual.objective, gap,
                    error(p.velocity_error), error(p.kinetic_error), p.state_changes);
  }
  return text;
}

ReportWriter::ReportWriter(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_ / "curves", error);
  if (error)
    throw RunError(
        fmt::format("cannot create {}: {}", (folder_ / "curves").string(), error.message()));
  const fs::path file = folder_ / "results.csv";
  results_ = std::fopen(file.c_str(), "w");
  if (results_ == nullptr) throw RunError(io_message("cannot write", file, errno));
  append(results_header());
}

ReportWriter::~ReportWriter() {
  if (results_ != nullptr) std::fclose(results_);
}

void ReportWriter::append(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), results_) == text.size();
  if (!written || std::fflush(results_) != 0)
    throw RunError(io_message("cannot write", folder_ / "results.csv", errno));
}

void ReportWriter::add(const ProblemReport& report) {
  const double least = least_objective(report);
  for (const SolverRun& run : report.runs)
    write_file_atomically(folder_ / "curves" / (report.name + "_" + run.solver + ".csv"),
                          curve_csv(run, least));
  append(results_lines(report));
}

void ReportWriter::finish(const std::vector<ProblemReport>& reports,
                          const std::vector<SkippedProblem>& skipped,
                          const AssembledOptions& options) {
  write_file_atomically(folder_ / "results.json",
                        to_json(reports, skipped, options).dump(2) + "\n");
  if (reports.size() < 2) return;
  write_file_atomically(folder_ / "profile_seconds.csv", to_csv(seconds_profile(reports)));
  write_file_atomically(folder_ / "profile_applications.csv",
                        to_csv(applications_profile(reports)));
}

}  // namespace scree
