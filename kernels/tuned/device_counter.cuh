#pragma once
// Counters by which the blocks of one launch wait for each other.

#include <cuda/atomic>

namespace scree {

using DeviceCounter = cuda::atomic_ref<unsigned, cuda::thread_scope_device>;

/// Waits until a counter has reached a value; what was written before it did is visible then.
__device__ inline void wait_for(unsigned& counter, unsigned value) {
  while (DeviceCounter(counter).load(cuda::memory_order_acquire) < value) {
  }
}

}  // namespace scree
