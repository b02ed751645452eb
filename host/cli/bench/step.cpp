#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "host/cli/bench/bandwidth.h"
#include "host/cli/bench/bed_bench.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"
#include "host/engine/copy_bandwidth.h"
#include "host/error.h"
#include "host/state_hash.h"

namespace scree {
namespace {

void print_rows(Table& table, const std::string& level, const StepFigures& f,
                const Bandwidth& moved, const std::string& hash) {
  const auto times = [&](double Spread::*kind) {
    std::vector<std::string> cells;
    for (const StageSpread& stage : f.stages) cells.push_back(fixed(stage.ms.*kind, 3));
    return cells;
  };
  std::vector<std::string> cells{std::to_string(f.bodies),
                                 fixed(f.contacts, 0),
                                 level,
                                 fixed(f.applications, 1),
                                 digits(f.residual_relative),
                                 fmt::format("{}/{}", f.steps - f.not_converged, f.steps),
                                 "median"};
  for (const std::string& cell : times(&Spread::median)) cells.push_back(cell);
  cells.push_back(digits(f.body_seconds_per_s));
  cells.push_back(moved.is_counted() ? fixed(moved.of_copy, 3) : "-");
  cells.push_back(hash);
  table.row(cells);
  cells = {"", "", "", "", "", "", "mean"};
  for (const std::string& cell : times(&Spread::mean)) cells.push_back(cell);
  table.row(cells);
}

/// The level of --set solver.stop, else those that runs know by name.
std::vector<std::string> levels_of(const BedBench& bench) {
  const std::string key = "solver.stop=";
  std::vector<std::string> levels{"quality", "preview"};
  for (const std::string& setting : bench.settings())
    if (setting.rfind(key, 0) == 0) levels = {setting.substr(key.size())};
  return levels;
}

}  // namespace

int bench_step(const StepBenchOptions& options) {
  const bool walls = options.kind == "bed";
  if (!walls && options.kind != "column")
    throw InputError(
        fmt::format("--kind: \"{}\" is not allowed: expected bed or column", options.kind));
  const BedBench bench(options.bed, {.benchmark = "step"});
  static_cast<void>(bench.bed(1, walls));
  const double copy = copy_bandwidth(bench.world_options());
  BenchRecord record = bench.record({{"copy_bandwidth_bytes_per_s", copy}});
  bench.print_title();
  fmt::print("{}, warm started; times in ms a step; memory copies {:.4g} GB/s\n",
             walls ? "settled bed" : "collapsing column", 1e-9 * copy);
  Table table({{"bodies"},
               {"contacts", 11},
               {"stop", 8},
               {"applic.", 8},
               {"residual/v*", 11},
               {"converged", 9},
               {"ms", 7},
               {"collision"},
               {"setup", 9},
               {"solve", 9},
               {"integrate", 9},
               {"total"},
               {"body-s/s", 9},
               {"of copy", 8},
               {"state", 16}});
  const std::vector<std::string> levels = levels_of(bench);
  for (const int size : bench.sizes()) {
    const BedParams bed = bench.bed(size, walls);
    std::optional<BedRun> run(settled_bed(bench, bed, {"solver.stop=" + levels.front()}));
    const WorldState state = run->world.save();
    const Json start = run->start;
    for (const std::string& level : levels) {
      if (level != levels.front()) {
        run.reset();  // one bed in memory at a time
        Scene scene = bench.scene(bed, {"solver.stop=" + level});
        const double h = scene.stepping.time_step;
        const SolverSettings solver = scene.solver;
        run.emplace(BedRun{World(std::move(scene), bench.world_options()), h, solver, start});
        run->world.restore(state);
        run->world.step();  // the first one allocates
      }
      const auto reports = run->steps(bench.steps());
      const StepFigures f = figures_of(reports, run->time_step, run->world.peak_memory());
      const Bandwidth moved = bandwidth_of(f, run->solver, bench.world_options(), copy);
      Json result = start;
      const std::string hash = fmt::format("{:016x}", state_hash(run->world.states()));
      result["stop"] = level;
      result["state_hash"] = hash;
      record.add(joined(joined(std::move(result), to_json(f)), to_json(moved)));
      print_rows(table, level, f, moved, hash);
    }
  }
  return 0;
}

}  // namespace scree
