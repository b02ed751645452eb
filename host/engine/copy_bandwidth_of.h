#pragma once
// Measures the copy bandwidth of a backend. Included by what is compiled once per backend.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

#include "kernels/backend/backend.h"

namespace scree {

/// Two machine words: copies of these are as wide as a thread can make them.
struct alignas(16) Block16 {
  std::uint64_t word[2];
};

template <class T>
struct CopyElements {
  static constexpr const char* name = "copy_elements";
  Span<const T> in;
  Span<T> out;
  SCREE_HD void operator()(Index i) const { out[i] = in[i]; }
};

/// Bytes read plus bytes written per second by a copy too large for any cache; the best of five.
template <class B>
double copy_bandwidth_of(B& b) {
  using Clock = std::chrono::steady_clock;
  constexpr Offset kBytes = B::kIsDevice ? 1 << 29 : 1 << 27;  // read, and as many written
  constexpr int kRuns = B::kIsDevice ? 20 : 1;
  const Index n = kBytes / sizeof(Block16);
  Buffer<B, Block16> source(b, n), target(b, n);
  fill(b, source.view(n), Block16{{0x0123456789abcdef, 0xfedcba9876543210}});
  const auto seconds = [&](int runs) {
    b.synchronize();
    const auto start = Clock::now();
    for (int k = 0; k < runs; ++k)
      for_each(b, n, CopyElements<Block16>{source.view(n), target.view(n)});
    b.synchronize();
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  seconds(1);
  double best = std::numeric_limits<double>::max();
  for (int k = 0; k < 5; ++k) best = std::min(best, seconds(kRuns) / kRuns);
  return 2.0 * kBytes / best;
}

}  // namespace scree
