#pragma once
// Counters by which the blocks of one launch wait for each other.

#include <cuda/atomic>

namespace scree {

using DeviceCounter = cuda::atomic_ref<unsigned, cuda::thread_scope_device>;

/// Waits until a counter has reached a value. What was written before it did is visible
/// after acquire().
__device__ inline void spin_until(unsigned& counter, unsigned value) {
  while (DeviceCounter(counter).load(cuda::memory_order_relaxed) < value) {
  }
}

/// Makes visible what others wrote before they told so. It empties the first-level cache of the
/// multiprocessor, so no loop should call it.
__device__ inline void acquire() {
  cuda::atomic_thread_fence(cuda::memory_order_acquire, cuda::thread_scope_device);
}

/// Waits until a counter has reached a value; what was written before it did is visible then.
__device__ inline void wait_for(unsigned& counter, unsigned value) {
  spin_until(counter, value);
  acquire();
}

}  // namespace scree
