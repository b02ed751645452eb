#include "host/io/run_record.h"

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>

#include "host/io/atomic_file.h"
#include "host/io/checkpoint.h"
#include "host/version.h"

namespace scree {
namespace {

using Json = nlohmann::ordered_json;

Json stage_times(const StageTimes& ms) {
  return {{"collision", ms.collision},
          {"setup", ms.setup},
          {"solve", ms.solve},
          {"integrate", ms.integrate},
          {"total", ms.total}};
}

Json totals_of(const RunTotals& totals) {
  return {{"steps", totals.steps()},
          {"steps_not_converged", totals.steps_not_converged()},
          {"stopped_at_walls", totals.stopped()},
          {"simulated_time_s", totals.simulated_time()},
          {"mean_ms", stage_times(totals.mean_ms())},
          {"mean_iterations", totals.mean_iterations()},
          {"max_contacts", totals.max_contacts()},
          {"max_residual_rms_m_per_s", totals.max_residual_rms()},
          {"max_residual_relative", totals.max_residual_relative()},
          {"max_penetration_m", totals.max_penetration()},
          {"final_bodies", totals.last().body_count},
          {"final_contacts", totals.last().contact_count},
          {"final_residual_rms_m_per_s", totals.last().residual_rms},
          {"final_kinetic_energy_J", totals.last().kinetic_energy}};
}

Json scene_of(const std::string& text) {
  Json scene = Json::parse(text, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  return scene.is_discarded() ? Json(text) : scene;
}

}  // namespace

void RunTotals::add(const StepReport& report) {
  steps_ += 1;
  steps_not_converged_ += report.converged ? 0 : 1;
  stopped_ += report.stopped;
  iterations_ += report.iterations;
  simulated_time_ = report.time;
  sum_ms_.collision += report.ms.collision;
  sum_ms_.setup += report.ms.setup;
  sum_ms_.solve += report.ms.solve;
  sum_ms_.integrate += report.ms.integrate;
  sum_ms_.total += report.ms.total;
  max_residual_rms_ = std::max(max_residual_rms_, report.residual_rms);
  max_residual_relative_ = std::max(max_residual_relative_, report.residual_relative);
  max_penetration_ = std::max(max_penetration_, report.max_penetration);
  max_contacts_ = std::max(max_contacts_, report.contact_count);
  last_ = report;
}

StageTimes RunTotals::mean_ms() const {
  const double per_step = steps_ > 0 ? 1.0 / static_cast<double>(steps_) : 0.0;
  return {sum_ms_.collision * per_step, sum_ms_.setup * per_step, sum_ms_.solve * per_step,
          sum_ms_.integrate * per_step, sum_ms_.total * per_step};
}

double RunTotals::mean_iterations() const {
  return steps_ > 0 ? static_cast<double>(iterations_) / static_cast<double>(steps_) : 0.0;
}

void write_run_record(const std::filesystem::path& path, const RunRecord& record) {
  Json json;
  json["program"] = "scree";
  json["version"] = version();
  json["commit"] = commit();
  json["status"] = to_string(record.status);
  if (!record.message.empty()) json["message"] = record.message;
  json["command_line"] = record.command_line;
  json["scene_name"] = record.scene_name;
  json["scene_file"] = record.scene_file;
  json["backend"] = to_string(record.backend);
  json["precision"] = to_string(record.precision);
  json["device"] = record.device;
  json["threads"] = record.threads;
  json["seed"] = record.seed;
  json["bodies"] = record.body_count;
  json["start_time"] = record.start_time;
  json["end_time"] = record.end_time.empty() ? Json(nullptr) : Json(record.end_time);
  json["wall_seconds"] = record.wall_seconds;
  if (record.resumed_from_step) json["resumed_from_step"] = *record.resumed_from_step;
  json["peak_memory_bytes"] = record.peak_memory_bytes;
  json["totals"] = totals_of(record.totals);
  json["scene"] = scene_of(record.scene_text);
  // A command line may hold bytes that are no UTF-8.
  write_file_atomically(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return {text, length};
}

const char* to_string(RunStatus status) {
  switch (status) {
    case RunStatus::running:
      return "running";
    case RunStatus::done:
      return "done";
    case RunStatus::interrupted:
      return "interrupted";
    case RunStatus::failed:
      return "failed";
  }
  return "unknown";
}

}  // namespace scree
