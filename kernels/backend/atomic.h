#pragma once
// Atomic operations an element program may use. Integers only: their result does not depend on the
// order in which threads arrive, so pictures have the same bits on every run.

#include <atomic>

#include "kernels/types.h"

namespace scree {

/// *address = min(*address, value), safely against other threads that do the same.
/// Nothing is ordered by it: read the result after the for_each that wrote it.
SCREE_HD inline void atomic_min(std::uint64_t* address, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  // A stale read is only ever too large, since values shrink; losing candidates skip the atomic.
  if (value < *reinterpret_cast<volatile std::uint64_t*>(address)) {
    atomicMin(reinterpret_cast<unsigned long long*>(address),
              static_cast<unsigned long long>(value));
  }
#else
  std::atomic_ref<std::uint64_t> target(*address);
  std::uint64_t seen = target.load(std::memory_order_relaxed);
  while (value < seen && !target.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

}  // namespace scree
