#pragma once
// The benchmarks of `scree bench`, one function each. They print a table, write the JSON file that
// the options name, and return the exit code. All of them throw InputError for bad options.

#include "host/cli/bench/bed_options.h"

namespace scree {

/// Cost of solver iterations on a settled bed, and the share of what the memory could do.
int bench_iteration(const BedOptions& options);

/// Collision detection on a settled bed.
int bench_collision(const BedOptions& options);

struct StepBenchOptions {
  BedOptions bed;
  std::string kind = "bed";  ///< bed or column
};
/// Whole steps to `quality` and to `preview`, stage by stage.
int bench_step(const StepBenchOptions& options);

/// Whole steps of beds on one rank and on those of this launch: weak and strong scaling.
int bench_scaling(const BedOptions& options);

/// Time to equal residual, solver by solver, on one identical step.
int bench_solvers(const SolverBenchOptions& options);

/// Memory expected and held, and how many bodies fit.
int bench_capacity(const BedOptions& options);

struct SceneBenchOptions {
  RunTarget target{.scene = "pile",
                   .backend = {},
                   .precision = {},
                   .threads = 0,
                   .transport = {},
                   .overrides = {},
                   .json = false};
  int warmup = 50;   ///< steps before measuring
  int steps = 20;    ///< steps measured
  std::string from;  ///< checkpoint to start from
  std::string json;  ///< file, or "-" for standard output; empty: none
};
/// Whole steps of a scene file, stage by stage.
int bench_scene(const SceneBenchOptions& options);

struct AffineBenchOptions {
  std::vector<std::string> scenes;  ///< files or names; empty: those that come with the program
  RunTarget target{.scene = {},
                   .backend = {},
                   .precision = "double",
                   .threads = 0,
                   .transport = {},
                   .overrides = {},
                   .json = false};
  int warmup = 20;   ///< steps before measuring
  int steps = 100;   ///< steps measured
  std::string json;  ///< as in SceneBenchOptions
};
/// Frames a second, iterations and least gaps of scenes of affine bodies, a line each.
int bench_affine(const AffineBenchOptions& options);

}  // namespace scree
