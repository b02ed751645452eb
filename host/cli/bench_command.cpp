#include "host/cli/bench_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/io/checkpoint.h"
#include "host/scene_reader.h"
#include "host/version.h"

namespace scree {
namespace {

constexpr int kMostSteps = 1'000'000;

struct Spread {
  double minimum = 0, median = 0, maximum = 0;
};

template <class F>
Spread spread_of(const std::vector<StepReport>& reports, F&& value) {
  std::vector<double> v;
  for (const StepReport& r : reports) v.push_back(value(r));
  std::sort(v.begin(), v.end());
  return {v.front(), v[v.size() / 2], v.back()};
}

}  // namespace

CLI::App* add_bench_command(CLI::App& app, BenchOptions& options) {
  CLI::App* command = app.add_subcommand("bench", "Time the steps of a scene, stage by stage");
  add_target_options(*command, options.target);
  command->get_option("scene")->required(false);
  command->add_option("--warmup", options.warmup, "steps before measuring")
      ->check(CLI::Range(0, kMostSteps))
      ->take_last();
  command->add_option("--steps", options.steps, "steps measured")
      ->check(CLI::Range(1, kMostSteps))
      ->take_last();
  command->add_option("--from", options.from, "checkpoint of this scene to start from")
      ->take_last();
  command->add_flag("--json", options.target.json, "print JSON");
  return command;
}

int bench_scene(const BenchOptions& options) {
  Scene scene = read_scene(find_scene(options.target.scene), options.target.overrides);
  std::string notice;
  const WorldOptions world_options = resolve_options(options.target, scene, &notice);
  World world(scene, world_options);
  scene.bodies = {};  // the world has its own
  scene.particles = {};
  scene.insertions = {};
  if (!options.from.empty()) world.restore(read_checkpoint(options.from).state);
  if (!notice.empty() && !options.target.json) fmt::print(stderr, "{}\n", notice);
  for (int k = 0; k < options.warmup; ++k) world.step();
  std::vector<StepReport> reports;
  for (int k = 0; k < options.steps; ++k) reports.push_back(world.step());

  const struct {
    const char* name;
    Spread ms;
  } stages[] = {
      {"collision", spread_of(reports, [](const StepReport& r) { return r.ms.collision; })},
      {"setup", spread_of(reports, [](const StepReport& r) { return r.ms.setup; })},
      {"solve", spread_of(reports, [](const StepReport& r) { return r.ms.solve; })},
      {"integrate", spread_of(reports, [](const StepReport& r) { return r.ms.integrate; })},
      {"total", spread_of(reports, [](const StepReport& r) { return r.ms.total; })}};
  double contacts = 0, applications = 0, iterations = 0, work = 0, solve_ms = 0, total_ms = 0;
  double worst_residual = 0, worst_relative = 0;
  int not_converged = 0;
  for (const StepReport& r : reports) {
    contacts += r.contact_count;
    applications += r.applications;
    iterations += r.iterations;
    work += static_cast<double>(r.contact_count) * r.applications;
    solve_ms += r.ms.solve;
    total_ms += r.ms.total;
    worst_residual = std::max(worst_residual, r.residual_rms);
    worst_relative = std::max(worst_relative, r.residual_relative);
    not_converged += r.converged ? 0 : 1;
  }
  const double n = static_cast<double>(reports.size());
  const double rate = solve_ms > 0 ? work / (solve_ms * 1e-3) : 0;
  const double body_seconds =
      total_ms > 0 ? reports.back().body_count * n * scene.stepping.time_step / (total_ms * 1e-3)
                   : 0;
  const DeviceInfo device = device_info(world_options.backend);
  const char* backend = world_options.backend == BackendKind::cuda ? "cuda" : "cpu";
  const char* precision =
      world_options.precision == Precision::double_precision ? "double" : "float";
  const int threads = world_options.threads > 0 ? world_options.threads : device.threads;

  if (options.target.json) {
    nlohmann::json ms;
    for (const auto& stage : stages) {
      ms[stage.name] = {
          {"min", stage.ms.minimum}, {"median", stage.ms.median}, {"max", stage.ms.maximum}};
    }
    const nlohmann::json out = {{"scene", scene.name},
                                {"commit", commit()},
                                {"device", device.name},
                                {"backend", backend},
                                {"precision", precision},
                                {"threads", threads},
                                {"solver", scene.solver.name},
                                {"bodies", reports.back().body_count},
                                {"contacts", contacts / n},
                                {"iterations", iterations / n},
                                {"applications", applications / n},
                                {"residual_rms_m_per_s", worst_residual},
                                {"residual_relative", worst_relative},
                                {"steps", reports.size()},
                                {"steps_not_converged", not_converged},
                                {"ms", ms},
                                {"contact_iterations_per_s", rate},
                                {"body_seconds_per_s", body_seconds},
                                {"peak_memory_bytes", world.peak_memory()}};
    fmt::print("{}\n", out.dump(2));
    return 0;
  }
  fmt::print("{} on {} ({}, {}, {} {}), commit {}\n", scene.name, device.name, backend, precision,
             threads, world_options.backend == BackendKind::cuda ? "multiprocessors" : "threads",
             commit());
  fmt::print("{} bodies, {:.0f} contacts; {}: {:.1f} iterations, {:.1f} applications a step\n",
             reports.back().body_count, contacts / n, scene.solver.name, iterations / n,
             applications / n);
  fmt::print("residual at most {:.3g} m/s RMS ({:.3g} v*); {} of {} steps at the iteration cap\n",
             worst_residual, worst_relative, not_converged, reports.size());
  fmt::print("{:<10} {:>10} {:>10} {:>10}\n", "ms a step", "min", "median", "max");
  for (const auto& stage : stages) {
    fmt::print("{:<10} {:>10.3f} {:>10.3f} {:>10.3f}\n", stage.name, stage.ms.minimum,
               stage.ms.median, stage.ms.maximum);
  }
  fmt::print(
      "{:.3g} contact-iterations/s in the solver; {:.3g} body-seconds simulated a second; {:.1f} "
      "MiB\n",
      rate, body_seconds, static_cast<double>(world.peak_memory()) / (1 << 20));
  return 0;
}

}  // namespace scree
