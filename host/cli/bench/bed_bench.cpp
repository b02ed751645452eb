#include "host/cli/bench/bed_bench.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/cli/judged.h"
#include "host/engine/expected_memory.h"
#include "host/error.h"
#include "host/io/streams.h"
#include "kernels/backend/ranks.h"

namespace scree {
namespace {

constexpr int kMostBodies = 2'000'000'000;
constexpr int kMostLayers = 1'000'000;
constexpr int kDefaultLayers = 20;
constexpr double kRestSpeed = 0.3;  // of v*: RMS speed below which a bed counts as settled
constexpr int kMostWarmups = 20;    // times the steps in which a bed sinks, until we give up

double mass_of(const Scene& scene) {
  double mass = 0;
  for (const ParticleSet& set : scene.particles)
    for (std::size_t i = 0; i < set.position.size(); ++i) mass += particle_mass(set, i);
  return mass;
}

void tell(const std::string& text) {
  if (isatty(STDERR_FILENO)) say(text);
}

}  // namespace

BedBench::BedBench(const BedOptions& options, const BedDefaults& defaults,
                   const std::shared_ptr<Ranks>& ranks)
    : benchmark_(defaults.benchmark),
      warmup_(options.warmup),
      steps_(options.steps > 0 ? options.steps : defaults.steps),
      polydisperse_(options.polydisperse),
      settings_(defaults.settings),
      json_(options.json) {
  const auto& overrides = options.target.overrides;
  settings_.insert(settings_.end(), overrides.begin(), overrides.end());
  sizes_ = whole_numbers("--sizes", options.sizes, kMostBodies, "numbers of bodies");
  layers_ = whole_numbers("--layers", options.layers, kMostLayers, "numbers of layers");
  std::string notice;
  world_options_ =
      resolve_options(options.target, bed_scene({.count = 1}, settings_), &notice, ranks);
  world_options_.rank_calls = RankCalls::together;
  if (!notice.empty()) say(notice);
  if (sizes_.empty()) {
    sizes_ = world_options_.backend == BackendKind::cuda ? defaults.cuda_sizes : defaults.cpu_sizes;
  }
}

BedParams BedBench::bed(int count, bool walls) const {
  if (layers_.size() > 1)
    throw InputError(fmt::format("--layers: {} values, expected one", layers_.size()));
  BedParams bed;
  bed.count = count;
  bed.walls = walls;
  bed.polydisperse = polydisperse_;
  bed.layers = !layers_.empty() ? layers_[0]
               : walls          ? kDefaultLayers
                                : layers_of_cube(count, polydisperse_);
  return bed;
}

Scene BedBench::scene(const BedParams& bed, const std::vector<std::string>& more_settings) const {
  std::vector<std::string> settings = settings_;
  settings.insert(settings.end(), more_settings.begin(), more_settings.end());
  return bed_scene(bed, settings);
}

int BedBench::warmup(const BedParams& bed, double time_step) const {
  return warmup_ >= 0 ? warmup_ : static_cast<int>(std::ceil(warmup_time(bed) / time_step));
}

BenchRecord BedBench::record(const Json& more) const {
  Json header = bench_header(benchmark_, world_options_);
  header["settings"] = settings_;
  return {joined(std::move(header), more), json_};
}

void BedBench::print_title() const {
  fmt::print("{}\n", bench_title(bench_header(benchmark_, world_options_)));
}

std::vector<StepReport> BedRun::steps(int count) {
  std::vector<StepReport> reports;
  reports.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) reports.push_back(judged(world.step(), solver));
  return reports;
}

void require_room(const BedBench& bench, const BedParams& bed) {
  constexpr int kSmall = 10'000;
  constexpr double kPositions = 24;  // bytes a sphere of the description, on the host
  BedParams small = bed;
  small.count = std::min(bed.count, kSmall);
  const WorldOptions& options = bench.world_options();
  const double per_body = least_bytes_per_body(bench.scene(small), options);
  const double ranks_here = options.ranks != nullptr ? options.ranks->count_here() : 1;
  const double positions = ranks_here * kPositions;  // each rank reads the whole scene
  if (options.backend == BackendKind::cuda) {
    require_memory_for(bed.count, per_body, options);
    require_memory_for(bed.count, positions, WorldOptions{});
  } else {
    WorldOptions on_host = options;
    on_host.ranks = nullptr;  // ranks of other hosts would leave less for this one
    require_memory_for(bed.count, positions + per_body, on_host);
  }
}

BedRun settled_bed(const BedBench& bench, const BedParams& bed,
                   const std::vector<std::string>& more_settings) {
  require_room(bench, bed);
  Scene scene = bench.scene(bed, more_settings);
  const double mass = mass_of(scene), h = scene.stepping.time_step;
  const double v_star = h * norm(scene.gravity);
  const SolverSettings solver = scene.solver;
  const int warmup = bench.warmup(bed, h);
  const bool to_rest = bench.warms_up_to_rest(bed) && v_star > 0;
  Json start = {{"scene", scene.name},
                {"layers", bed.layers},
                {"polydisperse", bed.polydisperse},
                {"solver", solver.name},
                {"time_step_s", h}};
  tell(fmt::format("{} of {} bodies: {}{} steps of warm-up", scene.name, bed.count,
                   to_rest ? "at least " : "", warmup));
  BedRun run{World(std::move(scene), bench.world_options()), h, solver, std::move(start)};
  double speed = 0;  // RMS over v*
  int done = 0;
  const auto goes_on = [&] {
    return done < warmup || (to_rest && speed > kRestSpeed && done < kMostWarmups * warmup);
  };
  for (; goes_on(); ++done) {
    const double energy = run.world.step().kinetic_energy;
    if (v_star > 0) speed = std::sqrt(2 * energy / mass) / v_star;
  }
  run.start["warmup_steps"] = done;
  if (done > 0 && v_star > 0) run.start["start_rms_speed_relative"] = speed;
  if (to_rest && speed > kRestSpeed)
    say(fmt::format("{} of {} bodies still moves at {:.2g} v* after {} steps of warm-up",
                    run.start["scene"].get<std::string>(), bed.count, speed, done));
  return run;
}

Json joined(Json first, const Json& second) {
  if (second.is_object()) first.update(second);
  return first;
}

}  // namespace scree
