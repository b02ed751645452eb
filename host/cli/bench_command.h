#pragma once
// scree bench: the benchmarks that any user can run.

#include "host/cli/bench/modes.h"

namespace CLI {
class App;
}

namespace scree {

struct BenchOptions {
  SceneBenchOptions scene;
  AffineBenchOptions affine;
  BedOptions iteration;
  BedOptions collision;
  StepBenchOptions step;
  BedOptions scaling;
  SolverBenchOptions solvers;
  BedOptions capacity;
};

CLI::App* add_bench_command(CLI::App& app, BenchOptions& options);

/// Runs the benchmark that the command line chose.
int run_bench(const CLI::App& command, const BenchOptions& options);

}  // namespace scree
