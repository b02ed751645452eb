#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "host/cli/bench/bandwidth.h"
#include "host/cli/bench/bed_bench.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"
#include "host/cli/judged.h"
#include "host/engine/copy_bandwidth.h"
#include "host/error.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

/// A residual counts as reached up to the rounding of its evaluation.
constexpr double kSlack = 1.01;

struct OneStep {
  StepReport report;
  SolverSettings solver;
  double time_step = 0;         ///< [s]
  std::size_t peak_memory = 0;  ///< [bytes]
};

/// One time step from a stored state with any solver.
class SameStep {
 public:
  SameStep(const BedBench& bench, const BedParams& bed) : bench_(&bench), bed_(bed) {
    BedRun run = settled_bed(bench, bed, {"solver.name=apgd", "solver.stop=quality"});
    state_ = run.world.save();
    start_ = std::move(run.start);
    start_.erase("solver");
  }

  const Json& start() const { return start_; }

  /// @param level  residual at which to stop [v*]
  OneStep with(const std::string& solver, bool warm, double level, int most_iterations) const {
    Scene scene = bench_->scene(bed_, {"solver.name=" + solver});
    scene.solver.stop = {StopRule::Level::absolute, level * v_star(scene)};
    scene.solver.max_iterations = most_iterations;
    scene.solver.warm_start = warm;
    WorldState state = state_;
    if (!warm || solver != "apgd") state.at<double>("solver/memory").clear();  // it is of APGD
    OneStep step{{}, scene.solver, scene.stepping.time_step, 0};
    World world(std::move(scene), bench_->world_options());
    world.restore(state);
    step.report = world.step();
    if (step.report.ms.solve <= kRepeatBelow) {
      world.restore(state);  // once more, with the memory allocated
      step.report = world.step();
    }
    step.report = judged(step.report, step.solver);
    step.peak_memory = world.peak_memory();
    return step;
  }

 private:
  static constexpr double kRepeatBelow = 2000;  // [ms]

  static double v_star(const Scene& scene) {
    const double v = scene.stepping.time_step * norm(scene.gravity);
    if (!(v > 0)) throw InputError("gravity: zero is not allowed: residuals are relative to v*");
    return v;
  }

  const BedBench* bench_;
  BedParams bed_;
  WorldState state_;
  Json start_;
};

/// Solves to tighter and tighter levels until the time limit ends a solve.
class LevelSearch {
 public:
  LevelSearch(const SameStep& step, std::string solver, bool warm, double limit, int check_every)
      : step_(&step),
        solver_(std::move(solver)),
        warm_(warm),
        limit_ms_(1e3 * limit),
        check_every_(check_every) {}

  /// @param level  [v*]; at most that of the call before
  OneStep to(double level) {
    if (!time_ms_) {  // what an iteration costs
      const StepReport probe = step_->with(solver_, warm_, kUnreachable, 2 * check_every_).report;
      time_ms_ = probe.ms.solve / std::max(probe.applications, 1);
    }
    if (!gave_up_) {
      const double most = std::clamp(limit_ms_ / std::max(*time_ms_, 1e-6), 1.0, 1e8);
      const int blocks = static_cast<int>(std::ceil(most / check_every_));
      last_ = step_->with(solver_, warm_, level, blocks * check_every_);
      const StepReport& report = last_.report;
      gave_up_ = !report.converged;
      if (report.applications > 2 * check_every_) time_ms_ = report.ms.solve / report.applications;
    }
    return last_;
  }

 private:
  static constexpr double kUnreachable = 1e-12;

  const SameStep* step_;
  std::string solver_;
  bool warm_;
  double limit_ms_;
  int check_every_;
  std::optional<double> time_ms_;
  bool gave_up_ = false;
  OneStep last_;
};

/// Solvers to compare: all that run on the backend and know spheres, or those that are named.
std::vector<std::string> chosen_solvers(const SolverBenchOptions& options, BackendKind backend) {
  const std::vector<std::string> all = solver_names();
  for (const std::string& name : options.solvers)
    if (std::find(all.begin(), all.end(), name) == all.end())
      throw InputError(fmt::format("--solvers: \"{}\" is not allowed: expected some of {}", name,
                                   fmt::join(all, ", ")));
  if (!options.solvers.empty()) return options.solvers;
  std::vector<std::string> fit = solver_names(backend == BackendKind::cuda);
  std::erase_if(
      fit, [](const std::string& name) { return !solver_card(name).knows(ContactLayout::radial); });
  return fit;
}

}  // namespace

int bench_solvers(const SolverBenchOptions& options) {
  const BedBench bench(options.bed,
                       {.benchmark = "solvers", .cuda_sizes = {1'000'000}, .cpu_sizes = {10'000}});
  const bool on_gpu = bench.world_options().backend == BackendKind::cuda;
  const auto solvers = chosen_solvers(options, bench.world_options().backend);
  if (!(options.limit > 0))
    throw InputError(
        fmt::format("--limit: {} is not allowed: expected positive seconds", options.limit));
  auto levels = positive_numbers("--levels", options.levels, "residuals relative to v*");
  if (levels.empty()) levels = {3e-2, 1e-2, 1e-3, 1e-4};
  std::sort(levels.begin(), levels.end(), std::greater<>());
  std::vector<int> layers = bench.layers();
  if (layers.empty()) layers = on_gpu ? std::vector<int>{20, 500} : std::vector<int>{20, 100};
  const int check_every = bench.scene({.count = 1}).solver.check_every;

  const double copy = copy_bandwidth(bench.world_options());
  BenchRecord record =
      bench.record({{"limit_s", options.limit}, {"copy_bandwidth_bytes_per_s", copy}});
  bench.print_title();
  fmt::print("one step of a settled bed, the same for all; at most about {:g} s a solve\n",
             options.limit);
  Table table({{"bodies"},
               {"layers", 6},
               {"contacts", 9},
               {"start", 5},
               {"solver", 20},
               {"level/v*", 8},
               {"reached", 7},
               {"residual/v*", 11},
               {"iterations"},
               {"applic.", 8},
               {"solve ms", 9},
               {"step ms", 9}});
  for (const int size : bench.sizes()) {
    for (const int height : layers) {
      const SameStep step(bench, {.count = size, .layers = height});
      for (const bool warm : {true, false}) {
        for (const std::string& solver : solvers) {
          LevelSearch search(step, solver, warm, options.limit, check_every);
          for (const double level : levels) {
            const OneStep done = search.to(level);
            const StepReport& r = done.report;
            const bool reached = r.converged && r.residual_relative <= kSlack * level;
            const StepFigures f = figures_of({r}, done.time_step, done.peak_memory);
            const Bandwidth moved = bandwidth_of(f, done.solver, bench.world_options(), copy);
            const Json common = joined(joined(step.start(), to_json(f)), to_json(moved));
            record.add(joined(common, {{"solver", solver},
                                       {"start", warm ? "warm" : "cold"},
                                       {"level", level},
                                       {"reached", reached},
                                       {"bodies", r.body_count},
                                       {"contacts", r.contact_count},
                                       {"iterations", r.iterations},
                                       {"applications", r.applications},
                                       {"residual_rms_m_per_s", r.residual_rms},
                                       {"residual_relative", r.residual_relative},
                                       {"objective_J", r.objective},
                                       {"solve_ms", r.ms.solve},
                                       {"step_ms", r.ms.total}}));
            table.row({std::to_string(r.body_count), std::to_string(height),
                       std::to_string(r.contact_count), warm ? "warm" : "cold", solver,
                       digits(level), reached ? "yes" : "no", digits(r.residual_relative),
                       std::to_string(r.iterations), std::to_string(r.applications),
                       fixed(r.ms.solve, 2), fixed(r.ms.total, 2)});
          }
        }
      }
    }
  }
  return 0;
}

}  // namespace scree
