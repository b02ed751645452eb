#pragma once
// Tuned twin of the two APGD passes for the radial layout: one cooperative launch runs many trials.
//
// A block takes tiles of bodies that are neighbors in space (Morton order), one in each round. It
// fetches their V_y into shared memory while the tile before is at work, steps their contacts,
// keeps the new impulses in shared memory too, and sums up there what contacts within the tile
// exert. Only contacts with bodies outside the tile go through global memory: as B of a lower body,
// whose tile has its contact step in the same round or an earlier one. So the body pass of a round
// runs after the contact step of the next one, when that of its own round is done everywhere, and
// seldom waits. A large body among small ones has thousands of contacts, which all threads of a
// warp sum up. At the end of a trial the blocks meet, one adds up the sums in block order and
// decides, and the next trial begins without a launch.
//
// Bytes from memory per contact (float, alike bodies): normal and bias 16, ids 8, two impulses 24,
// metric 4, list 4 read, impulse 12 written. Per body: V_y, v*, V 72, inertia 8, starts 8 read, V
// and V_y 48 written: 340 MB for 1e6 bodies with 3e6 contacts, where the plain passes take 427.
// What bounds it on an H200 is the link between the two halves of the second-level cache, which
// half of all sectors cross: busy 79 % of the time (bench/results/h200). Shared memory is dear:
// with less than 60 KB left to the first-level cache, records of 12 bytes are fetched more than
// once. Sums are those of the plain passes in another order: the same bits on every run of one
// device. Doubles take the plain passes, which are faster for them.

#include "kernels/tuned/apgd_tile.cuh"
#include "kernels/tuned/device_counter.cuh"

namespace scree {
namespace sweep {

inline constexpr int kBlocks = 4;  ///< wanted on a multiprocessor

/// What the blocks share, in device memory. All of it starts at zero with a solve.
struct Shared {
  unsigned* round_done;  ///< [rounds] contact steps done, over all trials
  unsigned* arrived;     ///< blocks at the end of a trial, over all trials
  unsigned* trials;      ///< trials decided
  Sums<3>* partial;      ///< [blocks]
};

/// Body pass of the thread's body of a tile: what other tiles exert, then its new velocity. A body
/// with many contacts is summed up by its warp.
template <class Real>
__device__ void step_body(const RadialPasses<Real>& a, const Trial<Real>& trial, Index i,
                          bool is_there, HalfDone<Real>& body, const Twist<Real>& extrapolated,
                          Sums<3>& sums) {
  using R = RadialRows<Real>;
  const Gather<Real> gather(a, trial);
  const bool is_long = is_there && body.is_long();
  if (is_there) gather.add_far(body);
  for (unsigned left = __ballot_sync(0xffffffffu, is_long); left != 0; left &= left - 1) {
    const int of = __ffs(static_cast<int>(left)) - 1;
    const auto lane = static_cast<int>(threadIdx.x % 32);
    const Wrench<Real> sum = gather.by_warp(i - lane + of);
    if (lane == of) body.wrench = sum;
  }
  if (!is_there) return;
  const Twist<Real> next =
      a.p.free_velocity[i] +
      R::apply_inverse_mass(a.p, i, Twist<Real>{body.wrench.force, body.wrench.torque});
  const Twist<Real> momentum = trial.next_beta * (next - trial.velocity[i]);
  trial.next_velocity[i] = next;
  trial.next_extrapolated[i] = next + momentum;
  const Twist<Real> change = next - extrapolated;
  const RadialInertia<Real> inertia = a.p.radial_inertia[i];
  Real energy = 0;
  if (inertia.inv_mass > Real(0)) energy += norm2(change.linear) * inverse(inertia.inv_mass);
  if (inertia.inv_spin > Real(0)) energy += norm2(change.angular) * inverse(inertia.inv_spin);
  sums.value[2] += static_cast<double>(energy);
}

/// Sum over the block in a fixed order, in thread 0.
__device__ inline Sums<3> block_sum(Sums<3> mine) {
  __shared__ Sums<3> of_warp[kThreads / 32];
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
    mine = threadIdx.x < kThreads / 32 ? of_warp[threadIdx.x] : Sums<3>{};
    over_warp(mine);
  }
  return mine;
}

/// Ends a trial: adds up the sums of all blocks and decides; returns when that is visible to all.
template <class Real>
__device__ void decide(const RadialPasses<Real>& a, const Shared& shared, unsigned trial,
                       const Sums<3>& sums) {
  __shared__ bool is_last;
  const Sums<3> mine = block_sum(sums);
  if (threadIdx.x == 0) {
    shared.partial[blockIdx.x] = mine;
    is_last = DeviceCounter(*shared.arrived).fetch_add(1, cuda::memory_order_acq_rel) ==
              (trial + 1) * gridDim.x - 1;
  }
  __syncthreads();
  if (is_last) {
    Sums<3> rest;
    for (unsigned k = threadIdx.x; k < gridDim.x; k += kThreads) rest.combine(shared.partial[k]);
    const Sums<3> total = block_sum(rest);
    if (threadIdx.x == 0) {
      ApgdContactFinish{a.state}({{total.value[0], total.value[1]}});
      ApgdBodyFinish{a.state}({{total.value[2]}});
      DeviceCounter(*shared.trials).store(trial + 1, cuda::memory_order_release);
    }
  } else if (threadIdx.x == 0) {
    wait_for(*shared.trials, trial + 1);
  }
  __syncthreads();
}

template <class Real>
__global__ void __launch_bounds__(kThreads, kBlocks)
    run_trials(const __grid_constant__ RadialPasses<Real> a, const Shared shared, Index tiles,
               int count, double enough) {
  extern __shared__ __align__(16) unsigned char bytes[];
  TileMemory<Real>& memory = *reinterpret_cast<TileMemory<Real>*>(bytes);
  const auto blocks = static_cast<Index>(gridDim.x);
  const auto local = static_cast<Index>(threadIdx.x);
  __shared__ unsigned number;  // of the trial, for thread 0
  for (int left = count; left > 0; --left) {
    // No block ends a trial before all have begun it, so all read the same.
    if (local == 0) number = DeviceCounter(*shared.trials).load(cuda::memory_order_relaxed);
    const Trial<Real> trial(a);
    const Gather<Real> gather(a, trial);
    Sums<3> sums;
    auto t = static_cast<Index>(blockIdx.x);
    fetch_bodies(a, trial, t * kBodies, memory.bodies[0]);
    for (Index round = 0; t < tiles + blocks; t += blocks, ++round) {
      __pipeline_wait_prior(0);
      __syncthreads();
      const TileBodies<Real>& here = memory.bodies[round % 2];
      TileBodies<Real>& other = memory.bodies[(round + 1) % 2];
      HalfDone<Real> now;
      bool is_now = false;
      if (t < tiles) {
        TileRange range;
        range.begin = t * kBodies;
        range.count = min(kBodies, a.p.free_count - range.begin);
        range.first = here.a_start[0];
        range.last = here.a_start[range.count];
        step_contacts(a, trial, range, here, memory.pull, sums);
        __syncthreads();
        if (local == 0)
          DeviceCounter(shared.round_done[round]).fetch_add(1, cuda::memory_order_release);
        is_now = local < range.count;
        if (is_now) now = gather.within(range, here, memory.pull);
      }
      // What this round found takes the place of what the round before left.
      const Index i = (t - blocks) * kBodies + local;
      const bool is_before = round > 0 && local < kBodies && i < a.p.free_count;
      HalfDone<Real> before;
      Twist<Real> extrapolated;
      if (is_before) {
        before = memory.half_done[local];
        extrapolated = other.extrapolated[local];
      }
      if (is_now) memory.half_done[local] = now;
      if (t + blocks < tiles) fetch_bodies(a, trial, (t + blocks) * kBodies, other);
      if (round == 0) continue;
      if (local == 0) {
        const Index done = min(blocks, tiles - (round - 1) * blocks);
        wait_for(shared.round_done[round - 1], (number + 1) * static_cast<unsigned>(done));
      }
      __syncthreads();
      step_body(a, trial, i, is_before, before, extrapolated, sums);
    }
    decide(a, shared, number, sums);
    if (!(a.state->measure > enough)) break;
  }
}

}  // namespace sweep

template <>
class ApgdIteration<Cuda> {
 public:
  explicit ApgdIteration(Cuda& cuda) : counters_(cuda), partial_(cuda) {}

  template <class R, class Real>
  void start(Cuda&, const ApgdPasses<R, Real>&) {}

  void start(Cuda& cuda, const sweep::RadialPasses<float>& a) {
    tiles_ = (a.p.free_count + sweep::kBodies - 1) / sweep::kBodies;
    blocks_ = std::min<unsigned>(resident_blocks(cuda), tiles_);
    const Offset counters = Offset{tiles_} / blocks_ + 3;
    counters_.reserve_discard(counters);
    partial_.reserve_discard(blocks_);
    fill(cuda, counters_.view(counters), 0u);
    shared_ = {counters_.data() + 2, counters_.data(), counters_.data() + 1, partial_.data()};
  }

  template <class R, class Real>
  bool stops(const ApgdPasses<R, Real>&) const {
    return false;
  }
  bool stops(const sweep::RadialPasses<float>&) const { return true; }

  template <class R, class Real>
  void run(Cuda& cuda, const ApgdPasses<R, Real>& a, int count, double) {
    for (int k = 0; k < count; ++k) apgd_trial(cuda, a);
  }

  void run(Cuda& cuda, const sweep::RadialPasses<float>& a, int count, double enough) {
    sweep::RadialPasses<float> passes = a;
    void* arguments[] = {&passes, &shared_, &tiles_, &count, &enough};
    check_cuda(cudaLaunchCooperativeKernel(kernel(), blocks_, sweep::kThreads, arguments, kBytes,
                                           cuda.stream()),
               "apgd_sweep");
    cuda.check_launch("apgd_sweep");
  }

 private:
  static constexpr int kBytes = sizeof(sweep::TileMemory<float>);

  static const void* kernel() { return reinterpret_cast<const void*>(&sweep::run_trials<float>); }
  /// Blocks wait for each other, so all must be on the device at once.
  static unsigned resident_blocks(const Cuda& cuda) {
    check_cuda(cudaFuncSetAttribute(kernel(), cudaFuncAttributeMaxDynamicSharedMemorySize, kBytes),
               "shared memory of apgd_sweep");
    return cuda.resident_blocks(kernel(), "occupancy of apgd_sweep", kBytes);
  }

  Buffer<Cuda, unsigned> counters_;  ///< arrived, trials, round_done
  Buffer<Cuda, Sums<3>> partial_;
  sweep::Shared shared_{};
  Index tiles_ = 0;
  unsigned blocks_ = 0;
};

}  // namespace scree
