#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/bench/bed_bench.h"
#include "host/cli/bench/figures.h"
#include "host/cli/bench/modes.h"
#include "host/cli/bench/table.h"
#include "host/error.h"
#include "host/ranks/mpi_ranks.h"

namespace scree {
namespace {

/// What a row of warm steps took.
struct Scaled {
  StepFigures figures;
  double largest_share = 1;
  double ghost_share = 0;
  double messages = 0;    ///< of rank 0, a step
  double bytes = 0;       ///< the same
  std::string transport;  ///< between GPUs of ranks
  Json start;
};

/// @param ranks  that step the bed together; null: this one does alone
Scaled measure(BedBench bench, const BedParams& bed, const std::shared_ptr<Ranks>& ranks) {
  bench.set_ranks(ranks);
  BedRun run = settled_bed(bench, bed, {"solver.stop=quality"});
  run.world.step();
  const Ranks::Traffic before = ranks != nullptr ? ranks->sent() : Ranks::Traffic{};
  const std::vector<StepReport> reports = run.steps(bench.steps());
  const Ranks::Traffic after = ranks != nullptr ? ranks->sent() : Ranks::Traffic{};
  Scaled s;
  s.figures = figures_of(reports, run.time_step, run.world.peak_memory());
  s.largest_share = reports.back().largest_share;
  s.ghost_share = reports.back().ghost_share;
  s.messages = static_cast<double>(after.messages - before.messages) / bench.steps();
  s.bytes = static_cast<double>(after.bytes - before.bytes) / bench.steps();
  if (ranks != nullptr && bench.world_options().backend == BackendKind::cuda)
    s.transport = to_string(ranks->used_transport());
  s.start = run.start;
  return s;
}

/// One line of the table and one entry of the file.
void tell(Table& table, BenchRecord& record, const char* kind, int ranks, const Scaled& s,
          const std::optional<double>& efficiency) {
  const StepFigures& f = s.figures;
  const double applications = std::max(f.applications, 1.0);
  table.row({kind, std::to_string(ranks), std::to_string(f.bodies), fixed(f.contacts, 0),
             fixed(f.applications, 1), digits(f.residual_relative),
             fmt::format("{}/{}", f.steps - f.not_converged, f.steps),
             fixed(f.ms("collision").mean, 3), fixed(f.ms("solve").mean, 3),
             fixed(f.ms("total").mean, 3), efficiency ? fixed(*efficiency, 3) : "-",
             fixed(s.largest_share, 3), fixed(s.ghost_share, 4),
             s.transport.empty() ? "-" : s.transport,
             ranks > 1 ? fixed(s.messages / applications, 1) : "-",
             ranks > 1 ? fixed(s.bytes / applications / 1024, 1) : "-"});
  Json result = {{"kind", kind}, {"ranks", ranks}};
  if (!s.transport.empty()) result["transport"] = s.transport;
  if (efficiency) result["efficiency"] = *efficiency;
  result["largest_share"] = s.largest_share;
  result["ghost_share"] = s.ghost_share;
  result["messages_a_step"] = s.messages;
  result["bytes_sent_a_step"] = s.bytes;
  record.add(joined(joined(std::move(result), s.start), to_json(f)));
}

int measure_scaling(const BedOptions& options, const std::shared_ptr<Ranks>& ranks) {
  const int count = ranks != nullptr ? ranks->count() : 1;
  const bool leads = ranks == nullptr || ranks->rank() == 0;
  const BedBench bench(
      options,
      {.benchmark = "scaling", .cuda_sizes = {1'000'000, 4'000'000}, .cpu_sizes = {20'000}}, ranks);
  BenchRecord record = leads ? bench.record({{"ranks", count}}) : BenchRecord({}, {});
  if (leads) {
    bench.print_title();
    fmt::print(
        "settled bed, warm steps to quality; mean ms; one rank alone, then {} together\n"
        "messages and KiB: that rank 0 sends in an application of the operator, but for what GPUs "
        "write to peers\n",
        count);
  }
  Table table({{"scaling"},
               {"ranks", 5},
               {"bodies"},
               {"contacts", 11},
               {"applic.", 8},
               {"residual/v*", 11},
               {"converged", 9},
               {"collision"},
               {"solve", 9},
               {"total", 9},
               {"efficiency"},
               {"largest share", 13},
               {"ghosts", 8},
               {"transport"},
               {"messages", 8},
               {"KiB", 8}});
  for (const int size : bench.sizes()) {
    std::optional<Scaled> one;
    if (leads) {
      one = measure(bench, bench.bed(size), nullptr);
      tell(table, record, "one", 1, *one, std::nullopt);
    }
    if (count == 1) continue;
    const std::int64_t all = static_cast<std::int64_t>(size) * count;
    for (const bool is_weak : {true, false}) {
      if (is_weak && all > std::int64_t{2'000'000'000})
        throw InputError(
            fmt::format("--sizes {}: {} ranks make {} bodies, 2e9 are possible", size, count, all));
      const Scaled many = measure(bench, bench.bed(is_weak ? static_cast<int>(all) : size), ranks);
      if (!leads) continue;
      // Beds of other sizes need other numbers of iterations. Means, since steps that need many alternate with others.
      const auto per_application = [](const Scaled& s) {
        return s.figures.ms("total").mean / std::max(s.figures.applications, 1.0);
      };
      const double speedup = per_application(*one) / per_application(many);
      tell(table, record, is_weak ? "weak" : "strong", count, many,
           is_weak ? speedup : speedup / count);
    }
  }
  return 0;
}

/// Tables come from rank 0.
void be_silent() {
  if (std::freopen("/dev/null", "w", stdout) == nullptr) throw RunError("cannot open /dev/null");
}

}  // namespace

int bench_scaling(const BedOptions& options) {
  const std::shared_ptr<Ranks> ranks = mpi_ranks();
  if (ranks == nullptr) return measure_scaling(options, ranks);
  try {
    if (ranks->rank() > 0) be_silent();
    return measure_scaling(options, ranks);
  } catch (const InputError& error) {  // maybe of this rank alone
    ranks->abort(error.what(), 2);
    throw;  // not reached, which compilers do not see
  } catch (const std::exception& error) {
    ranks->abort(error.what(), 1);
    throw;
  }
}

}  // namespace scree
