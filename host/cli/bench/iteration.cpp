#include <fmt/format.h>

#include <utility>

#include "host/cli/bench/bandwidth.h"
#include "host/cli/bench/bed_bench.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"
#include "host/engine/copy_bandwidth.h"

namespace scree {
int bench_iteration(const BedOptions& options) {
  const BedBench bench(options, {.benchmark = "iteration",
                                 .steps = 5,
                                 .settings = {"solver.stop=fixed", "solver.max_iterations=100"}});
  static_cast<void>(bench.bed(1));  // --layers is checked before anything runs
  const double copy = copy_bandwidth(bench.world_options());
  BenchRecord record = bench.record({{"copy_bandwidth_bytes_per_s", copy}});
  bench.print_title();
  fmt::print("memory copies {:.4g} GB/s; times include residual checks and start of the solver\n",
             1e-9 * copy);
  Table table({{"bodies"},
               {"contacts", 11},
               {"iterations"},
               {"applic.", 8},
               {"residual/v*", 11},
               {"us/iteration", 12},
               {"cont.-it./s", 11},
               {"least MB/it.", 12},
               {"GB/s", 8},
               {"of copy", 8},
               {"B/body", 8}});
  for (const int size : bench.sizes()) {
    BedRun run = settled_bed(bench, bench.bed(size));
    const auto reports = run.steps(bench.steps());
    const StepFigures f = figures_of(reports, run.time_step, run.world.peak_memory());
    const double us = 1e3 * f.ms("solve").mean / f.iterations;
    const double us_application = 1e3 * f.ms("solve").mean / f.applications;
    const Bandwidth moved = bandwidth_of(f, run.solver, bench.world_options(), copy);
    Json result = joined(run.start, to_json(f));
    result["us_per_iteration"] = us;
    result["us_per_application"] = us_application;
    record.add(joined(std::move(result), to_json(moved)));
    table.row({std::to_string(f.bodies), fixed(f.contacts, 0), fixed(f.iterations, 1),
               fixed(f.applications, 1), digits(f.residual_relative), fixed(us, 2),
               digits(f.contact_iterations_per_s),
               moved.is_counted() ? digits(1e-6 * moved.least_bytes, 4) : "-",
               moved.is_counted() ? digits(1e-9 * moved.bytes_per_s, 4) : "-",
               moved.is_counted() ? fixed(moved.of_copy, 3) : "-", fixed(f.bytes_per_body(), 0)});
  }
  return 0;
}

}  // namespace scree
