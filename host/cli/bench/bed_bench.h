#pragma once
// What the benchmarks on beds have in common: the checked options, and a bed brought to rest.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/bench/bed_options.h"
#include "host/cli/bench/record.h"
#include "host/world.h"

namespace scree {

/// What a benchmark takes where the command line is silent.
struct BedDefaults {
  std::string benchmark;
  std::vector<int> cuda_sizes{100'000, 1'000'000, 10'000'000};
  std::vector<int> cpu_sizes{10'000, 100'000};
  int steps = 20;
  std::vector<std::string> settings = {};  ///< as of --set, which comes after them
};

class BedBench {
 public:
  /// @throws InputError  an option that is not allowed, a backend that is not there
  /// @param ranks  that step beds together, or null
  BedBench(const BedOptions& options, const BedDefaults& defaults,
           const std::shared_ptr<Ranks>& ranks = nullptr);

  /// Those that step the beds to come. @param ranks  null: this process alone
  void set_ranks(const std::shared_ptr<Ranks>& ranks) { world_options_.ranks = ranks; }

  const WorldOptions& world_options() const { return world_options_; }
  const std::vector<int>& sizes() const { return sizes_; }
  const std::vector<int>& layers() const { return layers_; }  ///< empty: not given
  int steps() const { return steps_; }
  const std::vector<std::string>& settings() const { return settings_; }

  /// A bed of so many spheres, as high as asked for: the only value of --layers, or by default 20
  /// layers, or as high as wide without walls. @throws InputError when --layers has several values
  BedParams bed(int count, bool walls = true) const;
  Scene scene(const BedParams& bed, const std::vector<std::string>& more_settings = {}) const;

  /// Steps in which a bed sinks or a column collapses by half, or what --warmup says.
  int warmup(const BedParams& bed, double time_step) const;

  /// Whether the warm-up goes on until the bed is at rest: a bed between walls, without --warmup.
  bool warms_up_to_rest(const BedParams& bed) const { return warmup_ < 0 && bed.walls; }

  /// File for the results; checked when made. @param more  goes into its header
  BenchRecord record(const Json& more = {}) const;
  void print_title() const;

 private:
  std::string benchmark_;
  WorldOptions world_options_;
  std::vector<int> sizes_, layers_;
  int warmup_ = -1;
  int steps_ = 0;
  bool polydisperse_ = false;
  std::vector<std::string> settings_;
  std::string json_;
};

/// A bed in motion or at rest after its warm-up.
struct BedRun {
  World world;
  double time_step = 0;  ///< [s]
  SolverSettings solver;
  Json start;  ///< the bed and how much it still moves, first entries of a result

  std::vector<StepReport> steps(int count);
};

/// Refuses a bed that does not fit in memory before it is made, by what a small one needs.
/// @throws InputError saying how many bodies fit
void require_room(const BedBench& bench, const BedParams& bed);

/// @throws InputError when the bed does not fit in memory
BedRun settled_bed(const BedBench& bench, const BedParams& bed,
                   const std::vector<std::string>& more_settings = {});

/// Both objects' entries, the first one's first.
Json joined(Json first, const Json& second);

}  // namespace scree
