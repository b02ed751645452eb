#include <fmt/format.h>

#include <new>

#include "host/cli/bench/bed_bench.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"
#include "host/error.h"
#include "kernels/backend/backend.h"

namespace scree {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

struct Held {
  StepFigures figures;
  double expected = 0;  ///< [bytes]
  Json start;
};

Held measure(const BedBench& bench, const BedParams& bed) {
  Held held;
  require_room(bench, bed);
  held.expected = static_cast<double>(expected_memory(bench.scene(bed), bench.world_options()));
  BedRun run = settled_bed(bench, bed);
  const auto reports = run.steps(bench.steps());
  held.figures = figures_of(reports, run.time_step, run.world.peak_memory());
  held.start = run.start;
  return held;
}

}  // namespace

int bench_capacity(const BedOptions& options) {
  BedOptions without_warmup = options;
  if (options.warmup < 0) without_warmup.warmup = 0;  // the memory is that of the first steps
  const BedBench bench(without_warmup,
                       {.benchmark = "capacity",
                        .cuda_sizes = {1'000'000, 10'000'000, 100'000'000},
                        .cpu_sizes = {10'000, 100'000, 1'000'000},
                        .steps = 10,
                        // Solves that go to their end take all the memory that a solver may take.
                        .settings = {"solver.stop=fixed", "solver.max_iterations=20"}});
  static_cast<void>(bench.bed(1));
  BenchRecord record = bench.record();
  const double there = static_cast<double>(
      device_info(bench.world_options().backend, bench.world_options().device).memory_bytes);
  bench.print_title();
  Table table({{"bodies"},
               {"contacts", 11},
               {"expected MiB", 12},
               {"peak MiB", 10},
               {"expected/peak", 13},
               {"B/body", 8},
               {"bodies that fit", 15},
               {"ms/step", 10},
               {"residual/v*", 11}});
  for (const int size : bench.sizes()) {
    std::string reason;
    try {
      const Held held = measure(bench, bench.bed(size));
      const StepFigures& f = held.figures;
      const double peak = static_cast<double>(f.peak_memory);
      const double fit = there / f.bytes_per_body();
      Json result = joined(held.start, to_json(f));
      result["fits"] = true;
      result["expected_memory_bytes"] = held.expected;
      result["bodies_that_fit"] = fit;
      record.add(result);
      table.row({std::to_string(f.bodies), fixed(f.contacts, 0), fixed(held.expected / kMiB, 1),
                 fixed(peak / kMiB, 1), fixed(held.expected / peak, 3),
                 fixed(f.bytes_per_body(), 0), digits(fit), fixed(f.ms("total").median, 2),
                 digits(f.residual_relative)});
      continue;
    } catch (const InputError& error) {
      reason = error.what();
    } catch (const OutOfMemory& error) {
      reason = error.what();
    } catch (const std::bad_alloc&) {
      reason = "host memory exhausted";
    }
    record.add({{"bodies", size}, {"fits", false}, {"reason", reason}});
    fmt::print("{} bodies do not fit: {}\n", size, reason);
    break;
  }
  return 0;
}

}  // namespace scree
