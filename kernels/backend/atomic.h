#pragma once
// Atomic operations an element program may use: smallest and largest values, and whole numbers that
// add up. Their result does not depend on the order in which threads arrive, so it has the same
// bits on every run.

#include <atomic>
#include <type_traits>

#include "kernels/types.h"

namespace scree {

/// *address = min(*address, value), safely against other threads that do the same.
/// Nothing is ordered by it: read the result after the for_each that wrote it.
/// @tparam Word  std::uint32_t or std::uint64_t
template <class Word>
SCREE_HD void atomic_min(Word* address, Word value) {
  static_assert(std::is_same_v<Word, std::uint32_t> || std::is_same_v<Word, std::uint64_t>);
#ifdef __CUDA_ARCH__
  using Native = std::conditional_t<sizeof(Word) == 8, unsigned long long, unsigned int>;
  // A stale read is only ever too large, since values shrink; losing candidates skip the atomic.
  if (value < *reinterpret_cast<volatile Word*>(address)) {
    atomicMin(reinterpret_cast<Native*>(address), static_cast<Native>(value));
  }
#else
  std::atomic_ref<Word> target(*address);
  Word seen = target.load(std::memory_order_relaxed);
  while (value < seen && !target.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

/// *address = max(*address, value) for values >= 0, safely against other threads that do the same.
/// Floats that are not negative order like their bits, so the result is the same on every run.
/// @param address  holds a value >= 0
SCREE_HD inline void atomic_max(float* address, float value) {
#ifdef __CUDA_ARCH__
  if (value > *reinterpret_cast<volatile float*>(address)) {
    atomicMax(reinterpret_cast<unsigned*>(address), __float_as_uint(value));
  }
#else
  std::atomic_ref<float> target(*address);
  float seen = target.load(std::memory_order_relaxed);
  while (value > seen && !target.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

/// *address += value, safely against other threads that do the same.
/// @return  what it was before: that does depend on the order, so a program that hands out places
///          by it must be followed by one that puts what is there into order
SCREE_HD inline Index atomic_add(Index* address, Index value) {
#ifdef __CUDA_ARCH__
  return atomicAdd(address, value);
#else
  return std::atomic_ref<Index>(*address).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// A number that other threads add to, maybe not the latest.
SCREE_HD inline Index atomic_read(Index* address) {
#ifdef __CUDA_ARCH__
  return *reinterpret_cast<volatile Index*>(address);
#else
  return std::atomic_ref<Index>(*address).load(std::memory_order_relaxed);
#endif
}

/// *mark = 1, safely against other threads that do the same.
SCREE_HD inline void atomic_mark(std::uint8_t* mark) {
#ifdef __CUDA_ARCH__
  *mark = 1;
#else
  std::atomic_ref<std::uint8_t>(*mark).store(1, std::memory_order_relaxed);
#endif
}

}  // namespace scree
