#pragma once
// What the benchmarks of one backend share: the backend, the bed in use, the clock, and the
// counters. Included by *.bench.h only, which find the backend under the name BenchBackend.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "bench/bed_problem.h"
#include "bench/options.h"
#include "host/engine/copy_bandwidth_of.h"
#include "solvers/traffic.h"

namespace scree::bench {

/// What one run of a measured operation did.
struct Work {
  double items = 0;
  const char* rate_name = "items_per_s";
  double least_bytes = 0;
  double requested_bytes = 0;  ///< 0: the same
};

/// Components that are NaN or infinite: an output poisoned with NaN must have none
/// after its kernel.
template <class Real>
struct CountBad {
  static constexpr const char* name = "count_bad";
  Span<const Vec3<Real>> values;
  SCREE_HD Sums<1> operator()(Index i) const { return {{is_finite(values[i]) ? 0.0 : 1.0}}; }
};

template <class B>
class Suite {
 public:
  explicit Suite(const Options& options)
      : backend_(make_backend(options)),
        batches_(options.batches > 0 ? options.batches : kBatches) {}

  B& backend() { return *backend_; }

  /// Registers "name/backend/variant/size". Errors of the backend become errors of the benchmark.
  template <class F>
  void add(const std::string& name, const std::string& variant, Index size, F run) {
    const std::string full = name + "/" + B::kName + "/" + variant + "/" + std::to_string(size);
    benchmark::RegisterBenchmark(full.c_str(),
                                 [this, run](benchmark::State& state) {
                                   try {
                                     run(*this, state);
                                   } catch (const std::exception& error) {
                                     state.SkipWithError(error.what());
                                   }
                                 })
        ->Iterations(batches_)
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  }

  /// The problem of a bed of this many spheres; kept until another size is asked for.
  template <class Real>
  const BedProblem<B, Real>& bed_problem(Index spheres) {
    if (!bed_ || bed_->sphere_count() != spheres) {
      problems_ = {};
      bed_.reset();
      bed_ = make_bed({.sphere_count = spheres});
    }
    auto& problem = std::get<std::unique_ptr<BedProblem<B, Real>>>(problems_);
    if (!problem) problem = std::make_unique<BedProblem<B, Real>>(*backend_, *bed_);
    return *problem;
  }

  /// Times `run`, which queues one operation on the backend, and reports what `work` says it did.
  /// A batch is as many runs as fill a few milliseconds, so that the wait at its
  /// end does not count.
  template <class F>
  void measure(benchmark::State& state, const Work& work, F run) {
    const int runs = runs_per_batch(run);
    std::vector<double> seconds;
    for (auto _ : state) {
      seconds.push_back(seconds_of(run, runs) / runs);
      state.SetIterationTime(seconds.back());
    }
    state.counters["runs_per_batch"] = runs;
    report(state, work, seconds);
  }

  /// Warms `run` up (module load, first touch, clocks) and says how many runs make a batch.
  template <class F>
  int runs_per_batch(F& run) {
    run();
    double once = seconds_of(run, 1);
    if (once >= kBatchSeconds) return kLeastRuns;
    for (int k = 0; k < 3; ++k) once = std::min(once, seconds_of(run, 2) / 2);
    const double wanted = std::ceil(kBatchSeconds / std::max(once, 1e-9));
    const int runs = static_cast<int>(std::clamp(wanted, double{kLeastRuns}, 1e6));
    seconds_of(run, runs);
    return runs;
  }

  /// Counters of a benchmark from the time of one run in each batch.
  void report(benchmark::State& state, const Work& work, std::vector<double> seconds) {
    if (seconds.empty()) return;
    std::sort(seconds.begin(), seconds.end());
    const std::size_t middle = seconds.size() / 2;
    const double median =
        seconds.size() % 2 ? seconds[middle] : (seconds[middle - 1] + seconds[middle]) / 2;
    if (!(median > 0)) return state.SetLabel("too short to time");  // a difference within the noise
    const double rate = work.least_bytes / median;
    state.counters["us_min"] = 1e6 * seconds.front();
    state.counters["us_median"] = 1e6 * median;
    state.counters["spread"] = (seconds.back() - seconds.front()) / median;
    state.counters[work.rate_name] = work.items / median;
    state.counters["bytes"] = work.least_bytes;
    state.counters["requested_bytes"] =
        work.requested_bytes > 0 ? work.requested_bytes : work.least_bytes;
    state.counters["GB_per_s"] = 1e-9 * rate;
    state.counters["of_copy"] = rate / copy_bandwidth();
  }

  /// Work of a pass over a bed.
  template <class Real>
  static Work contact_work(const BedProblem<B, Real>& bed, const Traffic& traffic) {
    const double contacts = bed.contact_count(), bodies = bed.owned_count();
    return {contacts, "contact_iterations_per_s", traffic.least(contacts, bodies),
            traffic.requested(contacts, bodies)};
  }
  template <class Real>
  static void report_size(benchmark::State& state, const BedProblem<B, Real>& bed) {
    state.counters["contacts"] = bed.contact_count();
    state.counters["bodies"] = bed.owned_count();
  }

  /// Seconds that `runs` queued runs take to complete.
  template <class F>
  double seconds_of(F& run, int runs) {
    using Clock = std::chrono::steady_clock;
    backend_->synchronize();
    const auto start = Clock::now();
    for (int k = 0; k < runs; ++k) run();
    backend_->synchronize();
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// Writes NaN to every component.
  template <class Real>
  void poison(Span<Vec3<Real>> values) {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    fill(*backend_, values, Vec3<Real>{nan, nan, nan});
  }
  /// Makes the benchmark fail unless every component is finite.
  template <class Real>
  void require_finite(benchmark::State& state, Span<const Vec3<Real>> values) {
    Buffer<B, Sums<1>> bad(*backend_, 1);
    reduce<Sums<1>>(*backend_, static_cast<Index>(values.size), CountBad<Real>{values},
                    StoreResult<Sums<1>>{bad.data()});
    const double count = fetch(*backend_, bad.data()).value[0];
    if (count > 0) state.SkipWithError("the kernel left elements that are not finite");
  }

  /// Bytes read plus bytes written per second by a copy too large for any cache; measured once.
  double copy_bandwidth() {
    if (copy_bandwidth_ == 0) copy_bandwidth_ = copy_bandwidth_of(*backend_);
    return copy_bandwidth_;
  }

  static Span<std::uint64_t> words(Buffer<B, Block16>& blocks) {
    return {&blocks.data()->word[0], 2 * blocks.capacity()};
  }

 private:
  static constexpr int kBatches = B::kIsDevice ? 20 : 5;
  static constexpr int kLeastRuns = B::kIsDevice ? 20 : 1;
  static constexpr double kBatchSeconds = B::kIsDevice ? 0.01 : 0.02;

  static std::unique_ptr<B> make_backend(const Options& options) {
    if constexpr (B::kIsDevice) {
      return std::make_unique<B>();
    } else {
      return std::make_unique<B>(options.threads);
    }
  }

  std::unique_ptr<B> backend_;
  int batches_;
  double copy_bandwidth_ = 0;
  std::optional<Bed> bed_;
  std::tuple<std::unique_ptr<BedProblem<B, float>>, std::unique_ptr<BedProblem<B, double>>>
      problems_;
};

// One function per *.bench.h file: adds its benchmarks for a bed of this many spheres.
void add_primitives(Suite<BenchBackend>& suite, Index spheres);
void add_contact_passes(Suite<BenchBackend>& suite, Index spheres);
void add_apgd(Suite<BenchBackend>& suite, Index spheres);
void add_operators(Suite<BenchBackend>& suite, Index spheres);

}  // namespace scree::bench
