#include <fmt/format.h>

#include <algorithm>

#include "dynamics/affine/affine_card.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"
#include "host/error.h"
#include "host/io/streams.h"
#include "host/scene_reader.h"

namespace scree {
namespace {

constexpr const char* kOwnScenes[] = {"house_of_cards", "gears", "chain_net"};

/// @throws InputError also when the scene is not one of affine bodies
Scene read_affine_scene(const AffineBenchOptions& options, const std::string& name) {
  Scene scene = read_scene(find_scene(name), options.target.overrides);
  if (scene.dynamics.type != affine_card().name)
    throw InputError(
        fmt::format("{}: dynamics.type: \"{}\" is not allowed: expected \"{}\"; scree bench scene "
                    "measures the others",
                    name, scene.dynamics.type, affine_card().name));
  return scene;
}

struct AffineFigures {
  StepFigures steps;
  double min_gap = kNoValue;  ///< [m]
  double max_strain = 0;
  double frames_per_s() const { return 1e3 / steps.ms("total").mean; }
};

AffineFigures measure(const Scene& scene, const WorldOptions& world_options,
                      const AffineBenchOptions& options) {
  World world(scene, world_options);
  for (int k = 0; k < options.warmup; ++k) world.step();
  AffineFigures f;
  std::vector<StepReport> reports;
  for (int k = 0; k < options.steps; ++k) {
    reports.push_back(world.step());
    f.min_gap = std::min(f.min_gap, reports.back().own.at(kMinGapColumn));
    f.max_strain = std::max(f.max_strain, reports.back().own.at(kStrainColumn));
  }
  f.steps = figures_of(reports, scene.stepping.time_step, world.peak_memory());
  return f;
}

Json to_json(const std::string& name, double time_step, const AffineFigures& f) {
  Json result = {{"scene", name}, {"time_step_s", time_step}, {"frames_per_s", f.frames_per_s()}};
  result.update(to_json(f.steps));
  for (const char* key : {"residual_relative", "residual_rms_m_per_s", "max_penetration_m",
                          "contact_iterations_per_s"})
    result.erase(key);
  result["residual_m_per_s"] = f.steps.residual_rms;
  result["min_gap_m"] = f.min_gap;
  result["max_strain"] = f.max_strain;
  return result;
}

}  // namespace

int bench_affine(const AffineBenchOptions& options) {
  require_json_name(options.json);
  std::vector<std::string> names = options.scenes;
  if (names.empty()) names.assign(std::begin(kOwnScenes), std::end(kOwnScenes));
  std::vector<WorldOptions> world_options;
  std::string notice;
  for (const std::string& name : names) {  // all of them before the first runs
    const Scene scene = read_affine_scene(options, name);
    world_options.push_back(resolve_options(options.target, scene, &notice));
    require_memory(scene, world_options.back());
  }
  const bool prints_json = options.json == "-";
  BenchRecord record(bench_header("affine", world_options.front()),
                     prints_json ? "" : options.json);
  if (!prints_json) {
    if (!notice.empty()) say(notice);
    fmt::print("{}\n", bench_title(record.document()));
  }
  Table table({{"scene", 24},
               {"bodies", 8},
               {"frames/s", 10},
               {"contacts", 9},
               {"Newton", 7},
               {"linear", 7},
               {"residual", 9},
               {"near ms", 9},
               {"set up ms", 9},
               {"linear ms", 9},
               {"rest ms", 9},
               {"gap m", 9},
               {"capped", 6}});
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Scene scene = read_affine_scene(options, names[k]);
    const AffineFigures f = measure(scene, world_options[k], options);
    record.add(to_json(scene.name, scene.stepping.time_step, f));
    if (prints_json) continue;
    const StepFigures& s = f.steps;
    table.row({scene.name, fmt::format("{}", s.bodies), digits(f.frames_per_s()),
               fmt::format("{:.0f}", s.contacts), fixed(s.iterations, 1), fixed(s.applications, 0),
               digits(s.residual_rms, 2), digits(s.ms("collision").mean),
               digits(s.ms("setup").mean), digits(s.ms("solve").mean),
               digits(s.ms("integrate").mean), digits(f.min_gap),
               fmt::format("{}", s.not_converged)});
  }
  if (prints_json) {
    fmt::print("{}\n", record.document().dump(2));
  } else {
    fmt::print(
        "residual: the largest of a step [m/s]; capped: steps that ended above their tolerance\n");
  }
  return 0;
}

}  // namespace scree
