#pragma once
// scree bench: whole time steps of a scene, per stage.

#include "host/cli/options.h"

namespace scree {

struct BenchOptions {
  RunTarget target{.scene = "pile",
                   .backend = {},
                   .precision = {},
                   .threads = 0,
                   .overrides = {},
                   .json = false};
  int warmup = 50;   ///< steps before measuring
  int steps = 20;    ///< steps measured
  std::string from;  ///< checkpoint to start from
};

CLI::App* add_bench_command(CLI::App& app, BenchOptions& options);
int bench_scene(const BenchOptions& options);

}  // namespace scree
