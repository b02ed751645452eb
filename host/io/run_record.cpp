#include "host/io/run_record.h"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host/io/atomic_file.h"
#include "host/io/checkpoint.h"
#include "host/version.h"

namespace scree {
namespace {

using Json = nlohmann::ordered_json;

Json stage_times(const RunTotals& totals) {
  Json ms = Json::object();
  for (const RunTotals::Stage& stage : totals.stages()) ms[stage.name] = stage.mean;
  return ms;
}

/// Quantities of the last step that only this model has.
void add_own(const RunTotals& totals, Json& json) {
  for (const ReportColumn& column : totals.card().report) {
    if (!std::holds_alternative<Own>(column.value) || totals.steps() == 0) continue;
    with_value(column, totals.last(),
               [&](auto value) { json[std::string("final_") + column.name] = value; });
  }
}

Json totals_of(const RunTotals& totals) {
  Json json;
  json["steps"] = totals.steps();
  const bool has_contacts = totals.card().has_contacts;
  if (has_contacts) {
    json["steps_not_converged"] = totals.steps_not_converged();
    json["stopped_at_walls"] = totals.stopped();
  }
  json["simulated_time_s"] = totals.simulated_time();
  json["mean_ms"] = stage_times(totals);
  if (has_contacts) {
    json["mean_iterations"] = totals.mean_iterations();
    json["max_contacts"] = totals.max_contacts();
    json["max_residual_rms_m_per_s"] = totals.max_residual_rms();
    json["max_residual_relative"] = totals.max_residual_relative();
    json["max_penetration_m"] = totals.max_penetration();
  }
  json["final_bodies"] = totals.last().body_count;
  if (has_contacts) {
    json["final_contacts"] = totals.last().contact_count;
    json["final_residual_rms_m_per_s"] = totals.last().residual_rms;
  }
  if (totals.card().has_column("kinetic_energy_J"))
    json["final_kinetic_energy_J"] = totals.last().kinetic_energy;
  add_own(totals, json);
  return json;
}

Json scene_of(const std::string& text) {
  Json scene = Json::parse(text, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  return scene.is_discarded() ? Json(text) : scene;
}

bool is_stage(const ReportColumn& column) { return std::string_view(column.name).ends_with("_ms"); }

}  // namespace

RunTotals::RunTotals(const DynamicsCard& card) : card_(card) {
  for (const ReportColumn& column : card_.report)
    if (is_stage(column)) sum_ms_.push_back(0);
}

void RunTotals::add(const StepReport& report) {
  steps_ += 1;
  steps_not_converged_ += report.converged ? 0 : 1;
  stopped_ += report.stopped;
  iterations_ += report.iterations;
  simulated_time_ = report.time;
  std::size_t stage = 0;
  for (const ReportColumn& column : card_.report)
    if (is_stage(column))
      with_value(column, report,
                 [&](auto value) { sum_ms_[stage++] += static_cast<double>(value); });
  max_residual_rms_ = std::max(max_residual_rms_, report.residual_rms);
  max_residual_relative_ = std::max(max_residual_relative_, report.residual_relative);
  max_penetration_ = std::max(max_penetration_, report.max_penetration);
  max_contacts_ = std::max(max_contacts_, report.contact_count);
  max_turn_ = std::max(max_turn_, report.max_turn);
  if (report.max_joint_error > max_joint_error_) {
    max_joint_error_ = report.max_joint_error;
    joint_error_step_ = report.step;
    joint_error_joint_ = report.max_joint_error_joint;
  }
  if (!report.converged && report.residual_max > unsolved_.residual)
    unsolved_ = {report.step, report.residual_max, report.residual_max_body_a,
                 report.residual_max_body_b, report.residual_max_joint};
  last_ = report;
}

std::vector<RunTotals::Stage> RunTotals::stages() const {
  const double per_step = steps_ > 0 ? 1.0 / static_cast<double>(steps_) : 0.0;
  std::vector<Stage> stages;
  for (const ReportColumn& column : card_.report) {
    if (!is_stage(column)) continue;
    const std::string name(column.name);
    stages.push_back({name.substr(0, name.size() - 3), sum_ms_[stages.size()] * per_step});
  }
  return stages;
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
  if (record.ranks > 1) json["ranks"] = record.ranks;
  if (!record.transport.empty()) json["transport"] = record.transport;
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

void write_run_failure(const std::filesystem::path& path, const std::string& message) {
  std::ifstream in(path);
  const Json json = Json::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || json.value("status", "") != to_string(RunStatus::running)) return;
  Json failed;
  for (const auto& [key, value] : json.items()) {
    failed[key] = value;
    if (key == "status") {
      failed[key] = to_string(RunStatus::failed);
      failed["message"] = message;
    } else if (key == "end_time") {
      failed[key] = utc_now();
    }
  }
  write_file_atomically(path, failed.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
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
    case RunStatus::joints_apart:
      return "joints_apart";
    case RunStatus::interrupted:
      return "interrupted";
    case RunStatus::failed:
      return "failed";
  }
  return "unknown";
}

}  // namespace scree
