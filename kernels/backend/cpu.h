#pragma once
// The CPU backend. One thread is the reference; any number of threads gives the same bits, because
// reductions run over fixed chunks combined in order and the radix sort is stable.

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include "kernels/backend/backend.h"

namespace scree {

class Cpu : public InRanks {
 public:
  static constexpr bool kIsDevice = false;
  static constexpr const char* kName = "cpu";

  /// @param threads  worker threads; 0 takes what OpenMP offers
  explicit Cpu(int threads = 0) : threads_(threads > 0 ? threads : omp_get_max_threads()) {}

  int threads() const { return threads_; }
  void synchronize() {}

  void* allocate(std::size_t bytes) {
    void* p = std::aligned_alloc(kAlignment, (bytes + kAlignment - 1) / kAlignment * kAlignment);
    if (p == nullptr) throw OutOfMemory(bytes, "host");
    allocated_ += bytes;
    peak_ = std::max(peak_, allocated_);
    return p;
  }
  void deallocate(void* p, std::size_t bytes) noexcept {
    std::free(p);
    allocated_ -= bytes;
  }
  /// Bytes held now, and the most ever held at once.
  std::size_t allocated() const { return allocated_; }
  std::size_t peak() const { return peak_; }

  void copy_bytes(void* destination, const void* source, std::size_t bytes) {
    if (bytes > 0) std::memmove(destination, source, bytes);
  }
  void upload_bytes(void* d, const void* s, std::size_t bytes) { copy_bytes(d, s, bytes); }
  void download_bytes(void* d, const void* s, std::size_t bytes) { copy_bytes(d, s, bytes); }

  void* result() { return result_; }

  void send_note(const void* source, std::size_t bytes) { std::memcpy(note_, source, bytes); }
  void read_note(void* destination, std::size_t bytes) { std::memcpy(destination, note_, bytes); }

  /// Uninitialized scratch for reductions; valid until the next call.
  void* scratch(std::size_t bytes) {
    if (scratch_.size() < bytes) scratch_.resize(bytes);
    return scratch_.data();
  }

 private:
  static constexpr std::size_t kAlignment = 64;
  int threads_;
  std::size_t allocated_ = 0;
  std::size_t peak_ = 0;
  std::vector<unsigned char> scratch_;
  unsigned char note_[kMostNoteBytes] = {};
  alignas(kAlignment) unsigned char result_[kMostResultBytes] = {};
};

template <>
class StageMarks<Cpu> {
 public:
  explicit StageMarks(Cpu&) {}
  void clear() { marks_.clear(); }
  void mark() { marks_.push_back(Clock::now()); }
  double ms(std::size_t k) const {
    return std::chrono::duration<double, std::milli>(marks_[k + 1] - marks_[k]).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<Clock::time_point> marks_;
};

/// Below this many elements a parallel region costs more than it saves; programs whose elements are
/// large name their own number.
template <class F>
constexpr Index serial_below() {
  if constexpr (requires { F::kSerialBelow; }) {
    return F::kSerialBelow;
  } else {
    return 512;
  }
}

/// Libraries whose programs are chains of small functions ask for all of them in one.
#ifdef SCREE_FLATTEN_PROGRAMS
#define SCREE_COMPILED_ONCE [[gnu::noinline, gnu::flatten]]
#else
#define SCREE_COMPILED_ONCE [[gnu::noinline]]
#endif

/// Elements [begin, end), in order. Programs are large functions: called here only, each is compiled once, and not once for
/// the serial and once for the parallel loop. @param f  by value, so that what it writes cannot be one of its own fields
template <class F>
SCREE_COMPILED_ONCE void run_elements(F f, Index begin, Index end) {
  for (Index i = begin; i < end; ++i) f(i);
}

/// run(begin, end) for [0, n) in as many ranges as there are threads.
template <class F>
void run_ranges(Cpu& cpu, Index n, F&& run) {
#pragma omp parallel num_threads(cpu.threads())
  {
    const Offset thread = omp_get_thread_num(), threads = omp_get_num_threads();
    run(static_cast<Index>(n * thread / threads), static_cast<Index>(n * (thread + 1) / threads));
  }
}

template <class F>
void for_each(Cpu& cpu, Index n, F f) {
  if (n < serial_below<F>() || cpu.threads() == 1)
    run_elements(f, 0, n);
  else
    run_ranges(cpu, n, [&](Index begin, Index end) { run_elements(f, begin, end); });
}

/// Elements in one piece of a sum; programs whose elements are large name their own number.
template <class F>
constexpr Index chunk_size() {
  if constexpr (requires { F::kChunk; }) {
    return F::kChunk;
  } else {
    return 1024;
  }
}

/// Sums of the chunks [begin, end) of the elements [0, n); see run_elements().
template <class R, class F>
SCREE_COMPILED_ONCE void sum_chunks(F f, Index n, Index begin, Index end, R* partial) {
  for (Index chunk = begin; chunk < end; ++chunk) {
    R sum;
    const Index first = chunk * chunk_size<F>(), last = std::min(n, first + chunk_size<F>());
    for (Index i = first; i < last; ++i) sum.combine(f(i));
    partial[chunk] = sum;
  }
}

/// Chunks have a fixed size, so partial sums do not depend on the thread count.
template <class R, class F, class G = NoFinish>
void reduce(Cpu& cpu, Index n, F f, G finish = {}) {
  const Index chunk_count = (n + chunk_size<F>() - 1) / chunk_size<F>();
  R* partial = static_cast<R*>(cpu.scratch(sizeof(R) * static_cast<std::size_t>(chunk_count)));
  if (chunk_count < 2 || cpu.threads() == 1)
    sum_chunks(f, n, 0, chunk_count, partial);
  else
    run_ranges(cpu, chunk_count,
               [&](Index begin, Index end) { sum_chunks(f, n, begin, end, partial); });
  R total;
  for (Index chunk = 0; chunk < chunk_count; ++chunk) total.combine(partial[chunk]);
  finish(total);
}

/// Adds up in 64 bits; a list may pass 2^31 entries.
/// @tparam Sum  Offset, or Index for sums below 2^31
template <class Sum>
void exclusive_scan(Cpu&, Span<const Index> in, Span<Sum> out) {
  Sum sum = 0;
  for (Offset i = 0; i < in.size; ++i) {
    out[i] = sum;
    sum += in[i];
  }
  out[in.size] = sum;
}

template <>
struct SortSpace<Cpu> {
  explicit SortSpace(Cpu& cpu) : keys(cpu), values(cpu) {}
  Buffer<Cpu, std::uint64_t> keys;
  Buffer<Cpu, Index> values;
};

/// Least significant digit radix sort, stable: equal keys keep their order for any thread count.
inline void sort_pairs(Cpu& cpu, SortSpace<Cpu>& space, Span<std::uint64_t> keys,
                       Span<Index> values, int bits) {
  constexpr int kDigitBits = 11;
  constexpr int kDigits = 1 << kDigitBits;
  const Offset n = keys.size;
  if (n < 2) return;
  space.keys.reserve_discard(n);
  space.values.reserve_discard(n);
  Span<std::uint64_t> from_keys = keys, to_keys = space.keys.view(n);
  Span<Index> from_values = values, to_values = space.values.view(n);

  const int threads = n < 1 << 14 ? 1 : cpu.threads();
  std::vector<Offset> counts(static_cast<std::size_t>(threads) * kDigits);
  for (int shift = 0; shift < bits; shift += kDigitBits) {
    std::fill(counts.begin(), counts.end(), 0);
    const auto digit = [&](Offset i) { return (from_keys[i] >> shift) & (kDigits - 1); };
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
      // The share of a thread is computed from the number of threads asked for,
      // so the two loops agree.
#pragma omp for schedule(static, 1)
      for (int t = 0; t < threads; ++t) {
        Offset* count = counts.data() + static_cast<std::size_t>(t) * kDigits;
        for (Offset i = n * t / threads; i < n * (t + 1) / threads; ++i) ++count[digit(i)];
      }
#pragma omp single
      {
        Offset sum = 0;
        for (int d = 0; d < kDigits; ++d) {
          for (int t = 0; t < threads; ++t) {
            Offset& c = counts[static_cast<std::size_t>(t) * kDigits + d];
            sum += std::exchange(c, sum);
          }
        }
      }
#pragma omp for schedule(static, 1)
      for (int t = 0; t < threads; ++t) {
        Offset* position = counts.data() + static_cast<std::size_t>(t) * kDigits;
        for (Offset i = n * t / threads; i < n * (t + 1) / threads; ++i) {
          const Offset p = position[digit(i)]++;
          to_keys[p] = from_keys[i];
          to_values[p] = from_values[i];
        }
      }
    }
    std::swap(from_keys, to_keys);
    std::swap(from_values, to_values);
  }
  if (from_keys.data != keys.data) {
    copy(cpu, Span<const std::uint64_t>(from_keys), keys);
    copy(cpu, Span<const Index>(from_values), values);
  }
}

}  // namespace scree
