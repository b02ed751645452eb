#include "host/cli/check_command.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "dynamics/dynamics_card.h"
#include "host/io/surface_frames.h"
#include "host/problems/body_problem.h"
#include "host/ranks/launch.h"
#include "host/scene/body_name.h"
#include "host/scene/overlaps.h"
#include "host/scene/run_summary.h"
#include "host/scene_reader.h"

namespace scree {
namespace {

nlohmann::json overlaps_json(const Overlaps& overlaps, const BodyConstants& bodies) {
  if (!overlaps.not_looked_for.empty()) return {{"not_looked_for", overlaps.not_looked_for}};
  nlohmann::json out = {{"pairs", overlaps.pairs}, {"has_more", overlaps.has_more}};
  if (overlaps.pairs == 0) return out;
  const auto body = [&](int id) {
    return nlohmann::json{{"id", id}, {"name", body_name(bodies, id)}};
  };
  out["deepest"] = {{"body_a", body(overlaps.body_a)},
                    {"body_b", body(overlaps.body_b)},
                    {"depth_m", overlaps.depth},
                    {"depth_over_diameter", overlaps.fraction}};
  return out;
}

constexpr double kLargeFile = 100e9;  // bytes

/// Frames of a whole run.
double frame_count(const Scene& settings) {
  const double interval = settings.output.frame_interval;
  return interval > 0 ? 1 + std::ceil(settings.stepping.duration / interval) : 2;
}

void print_surfaces(const Scene& settings, const SurfaceSize& size) {
  const double frames = frame_count(settings);
  fmt::print("surfaces    {} corners and {} faces of {} bodies, {:.1f} MiB in each of {} frames\n",
             size.corners, size.faces, size.bodies, size.frame_bytes() / (1 << 20), frames);
  if (size.frame_bytes() * frames > kLargeFile)
    fmt::print("warning     surfaces.vtkhdf will have {:.0f} GB, twice that while the run lasts\n",
               size.frame_bytes() * frames / 1e9);
}

}  // namespace

int check_scene(const CheckOptions& options) {
  std::vector<std::string> notes;
  Scene scene = read_scene(find_scene(options.target.scene), options.target.overrides, &notes);
  const WorldOptions world = resolve_options(options.target, scene);
  require_known_solver(options.target, scene, world, launch_of_environment().count > 1);
  const SceneSummary s = summarize_run(scene, world);
  const auto steps = std::llround(scene.stepping.duration / scene.stepping.time_step);
  const std::size_t memory = expected_memory(scene, world);
  const DeviceInfo device = device_info(world.backend, world.device);
  const double fit = bodies_that_fit(scene, world);
  const bool fits = s.free_capacity + s.fixed_count <= fit;
  const char* backend = world.backend == BackendKind::cuda ? "cuda" : "cpu";
  const char* precision = world.precision == Precision::double_precision ? "double" : "float";
  const BodyConstants bodies(scene);
  Scene settings;  // the descriptions of bodies go to the search for overlaps
  settings.name = scene.name;
  settings.dynamics = scene.dynamics;
  settings.stepping = scene.stepping;
  settings.solver = scene.solver;
  settings.output = scene.output;
  const DynamicsCard& card = dynamics_card(settings.dynamics.type);
  const std::size_t joints = scene.joints.size();
  std::optional<SurfaceSize> surfaces;
  if (scene.output.surface_frames) {
    surfaces = surface_size(scene);
    require_surface_size(*surfaces);
  }
  Overlaps overlaps;
  with_scene_file(options.target, [&] { overlaps = find_overlaps(std::move(scene), world); });
  if (options.target.json) {
    nlohmann::json out = {{"scene", settings.name},
                          {"valid", true},
                          {"free_bodies", s.free_capacity},
                          {"fixed_bodies", s.fixed_count},
                          {"joints", joints},
                          {"notes", notes},
                          {"median_diameter_m", s.median_diameter},
                          {"envelope_m", s.envelope},
                          {"dynamics", settings.dynamics.type},
                          {"time_step_s", settings.stepping.time_step},
                          {"steps", steps},
                          {"backend", backend},
                          {"precision", precision},
                          {"device", device.name},
                          {"device_memory_bytes", device.memory_bytes},
                          {"free_memory_bytes", device.free_bytes},
                          {"expected_memory_bytes", memory},
                          {"fits", fits},
                          {"bodies_that_fit", fit},
                          {"overlaps", overlaps_json(overlaps, bodies)},
                          {"warnings", overlaps.warnings}};
    if (card.has_contacts) {
      out["contact_layout"] = to_string(s.layout);
      out["solver"] = settings.solver.name;
    }
    if (surfaces)
      out["surfaces"] = {{"corners", surfaces->corners},
                         {"faces", surfaces->faces},
                         {"frame_bytes", surfaces->frame_bytes()}};
    fmt::print("{}\n", out.dump(2));
    return 0;
  }
  fmt::print("scene       {}: valid\n", settings.name);
  fmt::print("bodies      {} free, {} fixed or moved; median diameter {:.4g} m\n", s.free_capacity,
             s.fixed_count, s.median_diameter);
  if (joints > 0) fmt::print("joints      {}\n", joints);
  for (const std::string& note : notes) fmt::print("read        {}\n", note);
  fmt::print("dynamics    {}: {}\n", card.name, card.description);
  if (card.has_contacts)
    fmt::print("contacts    layout {}, listed up to a gap of {:.3g} m\n", to_string(s.layout),
               s.envelope);
  fmt::print("time step   {:g} s, {} steps for {:g} s\n", settings.stepping.time_step, steps,
             settings.stepping.duration);
  if (card.has_contacts)
    fmt::print("solver      {}{}, at most {} iterations a step\n", settings.solver.name,
               settings.solver.exact_coulomb ? ", exact Coulomb" : "",
               settings.solver.max_iterations);
  fmt::print("device      {} ({}, {})\n", device.name, backend, precision);
  fmt::print("memory      {:.1f} MiB expected{}, {:.0f} of {:.0f} MiB free\n",
             static_cast<double>(memory) / (1 << 20),
             settings.output.picture.interval >= 0 ? " without pictures" : "",
             static_cast<double>(device.free_bytes) / (1 << 20),
             static_cast<double>(device.memory_bytes) / (1 << 20));
  if (surfaces) print_surfaces(settings, *surfaces);
  if (!fits) fmt::print("warning     the scene does not fit: about {:.0f} bodies do\n", fit);
  if (overlaps.pairs > 0) fmt::print("warning     {}\n", overlap_warning(overlaps, bodies));
  for (const std::string& warning : overlaps.warnings) fmt::print("warning     {}\n", warning);
  return 0;
}

}  // namespace scree
