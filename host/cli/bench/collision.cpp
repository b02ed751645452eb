#include "host/cli/bench/bed_bench.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"

namespace scree {

int bench_collision(const BedOptions& options) {
  const BedBench bench(options, {.benchmark = "collision", .settings = {"solver.stop=preview"}});
  static_cast<void>(bench.bed(1));
  BenchRecord record = bench.record();
  bench.print_title();
  Table table({{"bodies"},
               {"contacts", 11},
               {"cont./body"},
               {"ms median"},
               {"ms mean"},
               {"ns/body"},
               {"ns/contact"},
               {"residual/v*", 11},
               {"B/body", 8}});
  for (const int size : bench.sizes()) {
    BedRun run = settled_bed(bench, bench.bed(size));
    const auto reports = run.steps(bench.steps());
    const StepFigures f = figures_of(reports, run.time_step, run.world.peak_memory());
    const Spread& ms = f.ms("collision");
    const double per_body = 1e6 * ms.median / f.bodies;
    const double per_contact = f.contacts > 0 ? 1e6 * ms.median / f.contacts : 0;
    Json result = joined(run.start, to_json(f));
    result["collision_ns_per_body"] = per_body;
    result["collision_ns_per_contact"] = per_contact;
    record.add(result);
    table.row({std::to_string(f.bodies), fixed(f.contacts, 0), fixed(f.contacts / f.bodies, 2),
               fixed(ms.median, 3), fixed(ms.mean, 3), fixed(per_body, 2), fixed(per_contact, 2),
               digits(f.residual_relative), fixed(f.bytes_per_body(), 0)});
  }
  return 0;
}

}  // namespace scree
