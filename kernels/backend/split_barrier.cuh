#pragma once
// A barrier of a block in two halves: a warp tells that it has come, goes on with other work, and
// waits for the others when it needs them. Phases follow each other; whoever waits names the parity
// of the phase, and no phase may end twice before all have waited for it.

#include <cstdint>
#include <cuda/atomic>

namespace scree {

/// In shared memory: the barrier object of the hardware from compute capability 9.0 on (PTX
/// "mbarrier"), else a counter.
class SplitBarrier {
 public:
  /// By one thread, before the block synchronizes. @param count  arrivals that end a phase
  __device__ void init(unsigned count);
  /// What the thread wrote before, and what others of its warp wrote before a __syncwarp(), is
  /// visible to those who wait.
  __device__ void arrive();
  /// Waits for the end of phase k, given k % 2. Before the first phase, that of parity 1 is over.
  __device__ void wait(unsigned parity);

 private:
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  __device__ unsigned address() { return static_cast<unsigned>(__cvta_generic_to_shared(&state_)); }
  std::uint64_t state_;
#else
  using Counter = cuda::atomic_ref<unsigned, cuda::thread_scope_block>;
  unsigned count_, arrived_;
#endif
};

#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900

__device__ inline void SplitBarrier::init(unsigned count) {
  asm volatile("mbarrier.init.shared.b64 [%0], %1;" ::"r"(address()), "r"(count) : "memory");
}
__device__ inline void SplitBarrier::arrive() {
  asm volatile("{\n .reg .b64 phase;\n mbarrier.arrive.shared.b64 phase, [%0];\n}" ::"r"(address())
               : "memory");
}
__device__ inline void SplitBarrier::wait(unsigned parity) {
  asm volatile(
      "{\n .reg .pred over;\n"
      "again%=:\n mbarrier.try_wait.parity.shared.b64 over, [%0], %1;\n"
      " @!over bra again%=;\n}" ::"r"(address()),
      "r"(parity)
      : "memory");
}

#else

__device__ inline void SplitBarrier::init(unsigned count) {
  count_ = count;
  arrived_ = 0;
}
__device__ inline void SplitBarrier::arrive() {
  Counter(arrived_).fetch_add(1, cuda::memory_order_release);
}
__device__ inline void SplitBarrier::wait(unsigned parity) {
  while (Counter(arrived_).load(cuda::memory_order_acquire) / count_ % 2 == parity) {
  }
}

#endif

}  // namespace scree
