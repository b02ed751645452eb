#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "dynamics/dynamics_card.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/checkpoint.h"
#include "host/io/streams.h"
#include "host/scene_reader.h"

namespace scree {

int bench_scene(const SceneBenchOptions& options) {
  require_json_name(options.json);
  Scene scene = read_scene(find_scene(options.target.scene), options.target.overrides);
  std::string notice;
  const WorldOptions world_options = resolve_options(options.target, scene, &notice);
  require_known_solver(options.target, scene, world_options, false);
  require_memory(scene, world_options);
  const Json header = bench_header("scene", world_options);
  const bool prints_json = options.json == "-";
  BenchRecord record(header, prints_json ? "" : options.json);
  std::optional<World> made;
  with_scene_file(options.target, [&] { made.emplace(scene, world_options); });
  World& world = *made;
  scene.bodies = {};  // the world has its own
  scene.particles = {};
  scene.insertions = {};
  if (!options.from.empty()) restore_from(options.from, read_checkpoint(options.from), world);
  if (!notice.empty() && !prints_json) say(notice);
  for (int k = 0; k < options.warmup; ++k) world.step();
  std::vector<StepReport> reports;
  reports.reserve(static_cast<std::size_t>(options.steps));
  for (int k = 0; k < options.steps; ++k) reports.push_back(world.step());

  const StepFigures f = figures_of(reports, scene.stepping.time_step, world.peak_memory());
  const bool has_contacts = dynamics_card(scene.dynamics.type).has_contacts;
  Json result = {{"scene", scene.name}};
  if (has_contacts) result["solver"] = scene.solver.name;
  result.update(to_json(f, has_contacts));
  record.add(result);
  if (prints_json) {
    Json out = header;
    out.update(result);
    fmt::print("{}\n", out.dump(2));
    return 0;
  }
  fmt::print("{}: {}\n", scene.name, bench_title(header));
  if (has_contacts) {
    fmt::print("{} bodies, {:.0f} contacts; {}: {:.1f} iterations, {:.1f} applications a step\n",
               f.bodies, f.contacts, scene.solver.name, f.iterations, f.applications);
    fmt::print(
        "residual at most {:.3g} m/s RMS ({:.3g} v*), penetration {:.3g} m; {} of {} steps at the "
        "iteration cap\n",
        f.residual_rms, f.residual_relative, f.max_penetration, f.not_converged, f.steps);
  } else {
    fmt::print("{} bodies\n", f.bodies);
  }
  fmt::print("{:<10} {:>10} {:>10} {:>10} {:>10}\n", "ms a step", "min", "median", "mean", "max");
  for (const StageSpread& stage : f.stages) {
    const Spread& t = stage.ms;
    fmt::print("{:<10} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f}\n", stage.name, t.min, t.median,
               t.mean, t.max);
  }
  if (has_contacts)
    fmt::print("{:.3g} contact-iterations/s in the solver; ", f.contact_iterations_per_s);
  fmt::print("{:.3g} body-seconds simulated a second; {:.1f} MiB\n", f.body_seconds_per_s,
             static_cast<double>(f.peak_memory) / (1 << 20));
  return 0;
}

}  // namespace scree
