#pragma once
// Atomic operations an element program may use. Integers only: their result does not depend on the
// order in which threads arrive, so pictures have the same bits on every run.

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

/// *mark = 1, safely against other threads that do the same.
SCREE_HD inline void atomic_mark(std::uint8_t* mark) {
#ifdef __CUDA_ARCH__
  *mark = 1;
#else
  std::atomic_ref<std::uint8_t>(*mark).store(1, std::memory_order_relaxed);
#endif
}

}  // namespace scree
