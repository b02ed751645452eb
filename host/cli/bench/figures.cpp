#include "host/cli/bench/figures.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace scree {
namespace {

Spread spread_of(const std::vector<StepReport>& reports, double StageTimes::*stage) {
  std::vector<double> v;
  v.reserve(reports.size());
  for (const StepReport& r : reports) v.push_back(r.ms.*stage);
  std::sort(v.begin(), v.end());
  const double mean = std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
  return {v.front(), v[v.size() / 2], mean, v.back()};
}

}  // namespace

const Spread& StepFigures::ms(const std::string& stage) const {
  for (const StageSpread& each : stages)
    if (each.name == stage) return each.ms;
  throw std::logic_error("no stage " + stage);
}

StepFigures figures_of(const std::vector<StepReport>& reports, double time_step,
                       std::size_t peak_memory) {
  StepFigures f;
  f.steps = static_cast<int>(reports.size());
  f.bodies = reports.back().body_count;
  f.peak_memory = peak_memory;
  double work = 0, solve_ms = 0, total_ms = 0;
  for (const StepReport& r : reports) {
    f.contacts += static_cast<double>(r.contact_count) / f.steps;
    f.iterations += static_cast<double>(r.iterations) / f.steps;
    f.applications += static_cast<double>(r.applications) / f.steps;
    f.residual_rms = std::max(f.residual_rms, r.residual_rms);
    f.residual_relative = std::max(f.residual_relative, r.residual_relative);
    f.max_penetration = std::max(f.max_penetration, r.max_penetration);
    f.not_converged += r.converged ? 0 : 1;
    work += static_cast<double>(r.contact_count) * r.applications;
    solve_ms += r.ms.solve;
    total_ms += r.ms.total;
  }
  f.stages = {{"collision", spread_of(reports, &StageTimes::collision)},
              {"setup", spread_of(reports, &StageTimes::setup)},
              {"solve", spread_of(reports, &StageTimes::solve)},
              {"integrate", spread_of(reports, &StageTimes::integrate)},
              {"total", spread_of(reports, &StageTimes::total)}};
  if (solve_ms > 0) f.contact_iterations_per_s = work / (solve_ms * 1e-3);
  if (total_ms > 0)
    f.body_seconds_per_s = static_cast<double>(f.bodies) * f.steps * time_step / (total_ms * 1e-3);
  return f;
}

Json to_json(const StepFigures& f, bool has_contacts) {
  Json ms;
  for (const StageSpread& stage : f.stages) {
    const Spread& t = stage.ms;
    ms[stage.name] = {{"min", t.min}, {"median", t.median}, {"mean", t.mean}, {"max", t.max}};
  }
  Json out = {{"bodies", f.bodies},
              {"contacts", f.contacts},
              {"iterations", f.iterations},
              {"applications", f.applications},
              {"residual_rms_m_per_s", f.residual_rms},
              {"residual_relative", f.residual_relative},
              {"max_penetration_m", f.max_penetration},
              {"steps", f.steps},
              {"steps_not_converged", f.not_converged},
              {"converged", f.not_converged == 0},
              {"ms", ms},
              {"contact_iterations_per_s", f.contact_iterations_per_s},
              {"body_seconds_per_s", f.body_seconds_per_s},
              {"peak_memory_bytes", f.peak_memory},
              {"memory_bytes_per_body", f.bytes_per_body()}};
  if (has_contacts) return out;
  for (const char* key :
       {"contacts", "iterations", "applications", "residual_rms_m_per_s", "residual_relative",
        "max_penetration_m", "steps_not_converged", "converged", "contact_iterations_per_s"})
    out.erase(key);
  return out;
}

}  // namespace scree
