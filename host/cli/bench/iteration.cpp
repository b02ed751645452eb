#include <fmt/format.h>

#include "host/cli/bench/bed_bench.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"
#include "host/copy_bandwidth.h"
#include "solvers/traffic.h"

namespace scree {
namespace {

/// Least bytes of one iteration; 0 for solvers whose traffic nobody has counted.
double least_bytes(const SolverSettings& solver, Precision precision, double contacts,
                   double bodies) {
  if (solver.name != "apgd" || solver.exact_coulomb) return 0;
  const auto metric = solver.diagonal_metric ? ApgdMetricKind::diagonal : ApgdMetricKind::euclidean;
  const Traffic traffic = precision == Precision::double_precision
                              ? apgd_fused_iteration_traffic<double>(metric)
                              : apgd_fused_iteration_traffic<float>(metric);
  return traffic.least(contacts, bodies);
}

}  // namespace

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
    const double bytes =
        least_bytes(run.solver, bench.world_options().precision, f.contacts, f.bodies);
    const double rate = bytes / (1e-6 * us_application);
    Json result = joined(run.start, to_json(f));
    result["us_per_iteration"] = us;
    result["us_per_application"] = us_application;
    if (bytes > 0) {
      result["least_bytes_per_iteration"] = bytes;
      result["bytes_per_s"] = rate;
      result["of_copy_bandwidth"] = rate / copy;
    }
    record.add(result);
    table.row({std::to_string(f.bodies), fixed(f.contacts, 0), fixed(f.iterations, 1),
               fixed(f.applications, 1), digits(f.residual_relative), fixed(us, 2),
               digits(f.contact_iterations_per_s), bytes > 0 ? digits(1e-6 * bytes, 4) : "-",
               bytes > 0 ? digits(1e-9 * rate, 4) : "-", bytes > 0 ? fixed(rate / copy, 3) : "-",
               fixed(f.bytes_per_body(), 0)});
  }
  return 0;
}

}  // namespace scree
