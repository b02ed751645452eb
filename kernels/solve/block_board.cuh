#pragma once
// Where the blocks of one launch tell each other their sums, and wait for those of all others.

#include "kernels/backend/cuda.cuh"
#include "kernels/backend/device_counter.cuh"

namespace scree {

/// Adds three numbers up over the warp in a fixed order: lanes 8 j to 8 j + 7 get the j-th sum. Two of five rounds of
/// shuffles halve what is left to add, so it takes 6 of them and not 15.
__device__ inline double warp_sums(const Sums<3>& mine) {
  const bool upper = threadIdx.x & 16, odd = threadIdx.x & 8;
  const auto pass = [](double keep, double give, int step) {
    return keep + __shfl_xor_sync(0xffffffffu, give, step);
  };
  const double first =
      pass(upper ? mine.value[2] : mine.value[0], upper ? mine.value[0] : mine.value[2], 16);
  const double second = pass(upper ? 0 : mine.value[1], upper ? mine.value[1] : 0, 16);
  double sum = pass(odd ? second : first, odd ? first : second, 8);
#pragma unroll
  for (int step = 4; step > 0; step /= 2) sum = pass(sum, sum, step);
  return sum;
}
/// The sum that the lane has to pass on, or -1.
__device__ inline int told_by_lane() {
  const auto lane = static_cast<int>(threadIdx.x % 32);
  return lane % 8 == 0 && lane < 24 ? lane / 8 : -1;
}

/// In device memory; the counter is zero before the first round.
///
/// One thread of a block waits at the counter. That all blocks wait at the sums themselves, which would spare a way to
/// the second-level cache, made a trial of 132 blocks last 7 us longer: they ask for too much.
struct BlockBoard {
  unsigned* arrived;  ///< blocks, over all rounds
  /// [2 * blocks] Rounds take turns: a block may be in the next one while others still read, but none is two ahead.
  Sums<3>* told;

  /// Tells the sums of this block, and that what its threads wrote before is there. All threads of the block come here.
  /// @param of_warp  shared memory, [warps of the block]
  __device__ void tell(unsigned round, const Sums<3>& mine, Sums<3>* of_warp) const {
    const auto warp = threadIdx.x / 32, lane = threadIdx.x % 32;
    const int number = told_by_lane();
    const double of_mine = warp_sums(mine);
    if (number >= 0) of_warp[warp].value[number] = of_mine;
    __syncthreads();
    if (warp > 0) return;
    const double sum = warp_sums(lane < blockDim.x / 32 ? of_warp[lane] : Sums<3>{});
    if (number >= 0) told_by(round, blockIdx.x).value[number] = sum;
    __syncwarp();
    if (lane == 0) DeviceCounter(*arrived).fetch_add(1, cuda::memory_order_release);
  }
  /// Waits until all blocks have told, by one thread: what they wrote before is visible to those that synchronize with
  /// it.
  __device__ void wait(unsigned round) const { wait_for(*arrived, (round + 1) * gridDim.x); }

  /// Adds up what the blocks told, by the warps that it takes.
  /// @param of_warp  shared memory, [warps of the block] out, for added_up()
  __device__ void read(unsigned round, Sums<3>* of_warp) const {
    if (threadIdx.x / 32 >= warps_that_read()) return;
    const double sum = warp_sums(threadIdx.x < gridDim.x ? told_by(round, threadIdx.x) : Sums<3>{});
    const int number = told_by_lane();
    if (number >= 0) of_warp[threadIdx.x / 32].value[number] = sum;
  }
  static __device__ Sums<3> added_up(const Sums<3>* of_warp) {
    Sums<3> all;
    for (unsigned k = 0; k < warps_that_read(); ++k) all.combine(of_warp[k]);
    return all;
  }

 private:
  static __device__ unsigned warps_that_read() { return (gridDim.x + 31) / 32; }
  __device__ Sums<3>& told_by(unsigned round, unsigned block) const {
    return told[round % 2 * gridDim.x + block];
  }
};

}  // namespace scree
