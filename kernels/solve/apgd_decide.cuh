#pragma once
// The end of a trial of APGD where one launch runs many: the blocks meet, add up their sums, and decide.

#include "kernels/backend/cuda.cuh"
#include "kernels/backend/device_counter.cuh"
#include "kernels/solve/apgd_passes.h"

namespace scree {

inline constexpr int kApgdThreads = Cuda::kBlock;  ///< of a block
inline constexpr int kApgdWarps = kApgdThreads / 32;

/// Where the blocks meet, in device memory. All of it starts at zero with a solve.
struct ApgdMeeting {
  unsigned* arrived;  ///< blocks at the end of a trial, over all trials
  Sums<3>* partial;   ///< [blocks]
};

/// Sum over the block in a fixed order, in thread 0.
__device__ inline Sums<3> block_sum(Sums<3> mine) {
  __shared__ Sums<3> of_warp[kApgdWarps];
  const auto over_warp = [](Sums<3>& x) {
#pragma unroll
    for (int step = 16; step > 0; step /= 2) {
#pragma unroll
      for (int k = 0; k < 3; ++k) x.value[k] += __shfl_down_sync(0xffffffffu, x.value[k], step);
    }
  };
  over_warp(mine);
  __syncthreads();
  if (threadIdx.x % 32 == 0) of_warp[threadIdx.x / 32] = mine;
  __syncthreads();
  if (threadIdx.x < 32) {
    mine = threadIdx.x < kApgdWarps ? of_warp[threadIdx.x] : Sums<3>{};
    over_warp(mine);
  }
  return mine;
}

/// Ends a trial on this device: adds up the sums of all blocks, which have written their velocities by then. Each block
/// does so by itself, sooner than the word of one would reach it, and finds the same bits.
/// @param meanwhile  to be done while other blocks finish
/// @return           in thread 0
template <class Meanwhile>
__device__ Sums<3> meet_blocks(const ApgdMeeting& meeting, unsigned trial, const Sums<3>& sums,
                               const Meanwhile& meanwhile) {
  const Sums<3> mine = block_sum(sums);
  if (threadIdx.x == 0) {
    meeting.partial[blockIdx.x] = mine;
    DeviceCounter(*meeting.arrived).fetch_add(1, cuda::memory_order_release);
  }
  meanwhile();
  if (threadIdx.x == 0) wait_for(*meeting.arrived, (trial + 1) * gridDim.x);
  __syncthreads();
  // A block writes its next sums when all have read these: before, it waits for their contact steps.
  Sums<3> all;
  for (unsigned k = threadIdx.x; k < gridDim.x; k += kApgdThreads) all.combine(meeting.partial[k]);
  return block_sum(all);
}

/// Decides by the sums of all contacts and bodies; one thread does.
/// @param exact        as of ApgdPasses
/// @param is_foreseen  as of ApgdBodyFinish
__device__ inline void decide_alone(const Sums<3>& all, ApgdState& state, bool exact,
                                    bool is_foreseen) {
  ApgdContactFinish{&state}({{all.value[0], all.value[1]}});
  ApgdBodyFinish{&state, exact, is_foreseen}({{all.value[2]}});
}
/// The same by a block.
/// @param all  in thread 0
__device__ inline void decide(const Sums<3>& all, ApgdState& state, bool exact) {
  if (threadIdx.x == 0) decide_alone(all, state, exact, false);
  __syncthreads();
}

}  // namespace scree
