#pragma once
// Options that the benchmarks on beds share.

#include <string>
#include <vector>

#include "host/cli/options.h"
#include "host/scene/bed_scene.h"

namespace scree {

struct BedOptions {
  RunTarget target;  ///< its scene is not used
  std::vector<std::string> sizes;
  std::vector<std::string> layers;
  int warmup = -1;            ///< steps; -1: as many as the bed takes to settle
  int steps = 0;              ///< measured; 0: the default of the benchmark
  bool polydisperse = false;  ///< diameters of 1 to 10
  std::string json;
};

struct SolverBenchOptions {
  BedOptions bed;
  std::vector<std::string> solvers;
  std::vector<std::string> levels;
  double limit = 10;  ///< [s]
};

/// Numbers of a list such as "1e5,1e6". @throws InputError naming the option
std::vector<int> whole_numbers(const char* option, const std::vector<std::string>& texts,
                               int largest, const char* what);
std::vector<double> positive_numbers(const char* option, const std::vector<std::string>& texts,
                                     const char* what);

}  // namespace scree
