// Backend primitives over arrays of the length of a bed's contact arrays, three elements a sphere.

#include <utility>

#include "bench/suite.h"

namespace scree::bench {
namespace {

constexpr int kKeyBits = 40;

template <class T>
struct SumElements {
  static constexpr const char* name = "sum_elements";
  Span<const T> values;
  SCREE_HD Sums<1> operator()(Index i) const { return {{static_cast<double>(values[i])}}; }
};

/// Copies keys and values to where the sort works in place.
struct RefillPairs {
  static constexpr const char* name = "refill_pairs";
  Span<const std::uint64_t> source;
  Span<std::uint64_t> key;
  Span<Index> value;
  SCREE_HD void operator()(Index i) const {
    key[i] = source[i];
    value[i] = i;
  }
};

/// Counts neighbors out of order; equal keys must keep the order of their values.
struct CountUnsorted {
  static constexpr const char* name = "count_unsorted";
  Span<const std::uint64_t> key;
  Span<const Index> value;
  SCREE_HD Sums<1> operator()(Index i) const {
    if (i == 0) return {};
    const bool ordered = key[i - 1] < key[i] || (key[i - 1] == key[i] && value[i - 1] < value[i]);
    return {{ordered ? 0.0 : 1.0}};
  }
};

template <class B>
void run_copy(Suite<B>& suite, benchmark::State& state, Index n) {
  B& b = suite.backend();
  Buffer<B, Block16> source(b, n), target(b, n);
  for_each(b, 2 * n, RandomWords<std::uint64_t>{3, 64, Suite<B>::words(source)});
  suite.measure(state, {double(n), "elements_per_s", 32.0 * n, 0}, [&] {
    for_each(b, n, CopyElements<Block16>{source.view(n), target.view(n)});
  });
}

/// Three-component records: what the width of a load costs beside 16-byte ones.
template <class B, class Real>
void run_copy_vec3(Suite<B>& suite, benchmark::State& state, Index n) {
  B& b = suite.backend();
  Buffer<B, Vec3<Real>> source(b, n), target(b, n);
  for_each(b, n, RandomVectors<Real>{5, 1, {}, source.view(n)});
  suite.poison(target.view(n));
  suite.measure(state, {double(n), "elements_per_s", 2.0 * sizeof(Vec3<Real>) * n, 0}, [&] {
    for_each(b, n, CopyElements<Vec3<Real>>{source.view(n), target.view(n)});
  });
  suite.require_finite(state, std::as_const(target).view(n));
}

template <class B>
void run_reduce(Suite<B>& suite, benchmark::State& state, Index n) {
  B& b = suite.backend();
  Buffer<B, std::uint32_t> values(b, n);
  Buffer<B, Sums<1>> sum(b, 1);
  for_each(b, n, RandomWords<std::uint32_t>{7, 20, values.view(n)});
  suite.measure(state, {double(n), "elements_per_s", 4.0 * n, 0}, [&] {
    reduce<Sums<1>>(b, n, SumElements<std::uint32_t>{values.view(n)},
                    StoreResult<Sums<1>>{sum.data()});
  });
  double expected = 0;  // exact: integers below 2^53
  for (const std::uint32_t v : download(b, values.view(n))) expected += v;
  if (fetch(b, sum.data()).value[0] != expected) state.SkipWithError("wrong sum");
}

template <class B>
void run_scan(Suite<B>& suite, benchmark::State& state, Index n) {
  B& b = suite.backend();
  Buffer<B, Index> counts(b, n);
  Buffer<B, Offset> starts(b, Offset{n} + 1);
  for_each(b, n, RandomWords<Index>{9, 4, counts.view(n)});
  fill(b, starts.view(), Offset{-1});
  suite.measure(state, {double(n), "elements_per_s", 12.0 * n, 0}, [&] {
    exclusive_scan(b, std::as_const(counts).view(n), starts.view(Offset{n} + 1));
  });
  Offset expected = 0;
  for (const Index v : download(b, counts.view(n))) expected += v;
  if (fetch(b, starts.data() + n) != expected) state.SkipWithError("wrong scan");
}

/// Sorting happens in place, so each run first writes fresh keys: 20 bytes a pair
/// (8 read, 12 written).
template <class B>
void run_sort(Suite<B>& suite, benchmark::State& state, Index n) {
  B& b = suite.backend();
  Buffer<B, std::uint64_t> source(b, n), keys(b, n);
  Buffer<B, Index> values(b, n);
  SortSpace<B> space(b);
  for_each(b, n, RandomWords<std::uint64_t>{13, kKeyBits, source.view(n)});
  const double bytes = (20 + sort_bytes(kKeyBits, B::kIsDevice)) * n;
  suite.measure(state, {double(n), "elements_per_s", bytes, 0}, [&] {
    for_each(b, n, RefillPairs{source.view(n), keys.view(n), values.view(n)});
    sort_pairs(b, space, keys.view(n), values.view(n), kKeyBits);
  });
  Buffer<B, Sums<1>> bad(b, 1);
  reduce<Sums<1>>(b, n, CountUnsorted{keys.view(n), values.view(n)},
                  StoreResult<Sums<1>>{bad.data()});
  if (fetch(b, bad.data()).value[0] != 0) state.SkipWithError("not sorted");
}

}  // namespace

void add_primitives(Suite<BenchBackend>& suite, Index spheres) {
  using B = BenchBackend;
  using S = Suite<B>;
  using State = benchmark::State;
  const Index n = 3 * spheres;
  suite.add("copy", "16B", n, [n](S& s, State& state) { run_copy(s, state, n); });
  suite.add("copy", "vec3_float", n,
            [n](S& s, State& state) { run_copy_vec3<B, float>(s, state, n); });
  suite.add("copy", "vec3_double", n,
            [n](S& s, State& state) { run_copy_vec3<B, double>(s, state, n); });
  suite.add("reduce", "uint32", n, [n](S& s, State& state) { run_reduce(s, state, n); });
  suite.add("exclusive_scan", "int32", n, [n](S& s, State& state) { run_scan(s, state, n); });
  suite.add("sort_pairs", "40bit", n, [n](S& s, State& state) { run_sort(s, state, n); });
}

}  // namespace scree::bench
