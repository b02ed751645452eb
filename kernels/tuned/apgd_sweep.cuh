#pragma once
// Tuned twin of the two APGD passes for the radial layout: one cooperative launch runs many trials.
//
// A block takes tiles of bodies that are neighbors in space (Morton order), one in each round. It
// keeps their V_y and the new impulses of their contacts in shared memory, so that both passes
// gather from there. Only contacts with bodies outside the tile go through global memory: as B of a
// lower body, whose tile has its contact step in the same round or an earlier one. So the body pass
// of a round runs after the contact step of the next one, when that of its own round is done
// everywhere, and seldom waits. A large body among small ones has thousands of contacts, which all
// threads of a warp sum up. At the end of a trial the blocks meet, one adds up the sums in
// block order and decides, and the next trial begins without a launch.
//
// Bytes from memory per contact (float, alike bodies): normal and bias 16, ids 8, two impulses 24,
// metric 4, list 4 read, impulse 12 written. Per body: V_y, v*, V 72, inertia 8, starts 8 read, V
// and V_y 48 written: 340 MB for 1e6 bodies with 3e6 contacts, where the plain passes take 427.
// Sums are those of the plain passes in another order: the same bits on every run of one device.
// Doubles take the plain passes, which are faster for them.

#include "kernels/apgd_iteration.h"
#include "kernels/backend/cuda.cuh"
#include "kernels/tuned/device_counter.cuh"

namespace scree {
namespace sweep {

inline constexpr int kThreads = Cuda::kBlock;  ///< of a block
inline constexpr int kBodies = 240;            ///< of a tile
inline constexpr int kBlocks = 4;              ///< wanted on a multiprocessor
inline constexpr int kStaged =
    640;                           ///< contacts of a tile kept in shared memory, two tiles a block
inline constexpr int kAtOnce = 4;  ///< contacts of a body as B that are fetched together
inline constexpr Index kLongList = 96;  ///< contacts of a body that one thread sums up, at most

/// What the blocks share, in device memory. All of it starts at zero with a solve.
struct Shared {
  unsigned* round_done;  ///< [rounds] contact steps done, over all trials
  unsigned* arrived;     ///< blocks at the end of a trial, over all trials
  unsigned* trials;      ///< trials decided
  Sums<3>* partial;      ///< [blocks]
};

/// A tile in shared memory.
template <class Real>
struct Tile {
  struct Pull {
    Vec3<Real> impulse;
    Vec3<Real> normal;
  };
  Twist<Real> extrapolated[kBodies];
  Pull pull[kStaged];
};

/// Bodies [begin, end) and their contacts as A [first, last).
struct TileRange {
  Index begin, end;
  Index first, last;
};

template <class Real>
using RadialPasses = ApgdPasses<RadialRows<Real>, Real>;

/// Contact step of a tile.
template <class Real>
__device__ void step_contacts(const RadialPasses<Real>& a,
                              const ApgdContactStep<RadialRows<Real>, Real>& step, TileRange range,
                              Tile<Real>& tile, Sums<3>& sums) {
  const Index i = range.begin + static_cast<Index>(threadIdx.x);
  if (i < range.end) tile.extrapolated[threadIdx.x] = step.extrapolated[i];
  __syncthreads();
  for (Index c = range.first + static_cast<Index>(threadIdx.x); c < range.last; c += kThreads) {
    const Index body_b = a.p.body_b[c];
    const Twist<Real> v_b =
        body_b < range.end ? tile.extrapolated[body_b - range.begin] : step.extrapolated[body_b];
    const Sums<2> mine =
        step(a.p, a.metric, c, tile.extrapolated[a.p.body_a[c] - range.begin], v_b);
    if (c - range.first < kStaged) tile.pull[c - range.first] = {step.next[c], a.p.normal[c]};
    sums.value[0] += mine.value[0];
    sums.value[1] += mine.value[1];
  }
}

/// Sum of a body's contacts: force and torque.
template <class Real>
struct Wrench {
  Vec3<Real> force, torque;

  __device__ void add_as_a(const typename Tile<Real>::Pull& pull) {
    force -= pull.impulse;
    torque += cross(pull.impulse, pull.normal);
  }
  __device__ void add_as_b(const typename Tile<Real>::Pull& pull) {
    force += pull.impulse;
    torque += cross(pull.impulse, pull.normal);
  }
  /// Sum over the warp, the same bits in every lane.
  __device__ void add_over_warp() {
#pragma unroll
    for (int step = 16; step > 0; step /= 2) {
#pragma unroll
      for (int k = 0; k < 3; ++k) {
        force[k] += __shfl_xor_sync(0xffffffffu, force[k], step);
        torque[k] += __shfl_xor_sync(0xffffffffu, torque[k], step);
      }
    }
  }
};

/// Contacts of a body: as A these, as B the listed ones.
struct Lists {
  Index a_begin = 0, a_end = 0;
  Index b_begin = 0, b_end = 0;
  __device__ Index size() const { return a_end - a_begin + b_end - b_begin; }
};

/// Gathers what contacts of one tile exert.
template <class Real>
class Gather {
 public:
  __device__ Gather(const RadialPasses<Real>& a, TileRange range, const Tile<Real>& tile)
      : p_(a.p), gamma_(a.gamma.next(a.state->accepted).data), first_(range.first), tile_(tile) {}

  __device__ Lists lists(Index i) const {
    return {p_.a_start[i], p_.a_start[i + 1], p_.b_start[i], p_.b_start[i + 1]};
  }
  /// All contacts of a body, by one thread.
  __device__ Wrench<Real> by_thread(const Lists& list) const {
    Wrench<Real> sum;
    for (Index c = list.a_begin; c < list.a_end; ++c) sum.add_as_a(of_tile(c));
    // Several at a time: a list of three or four would wait for memory twice at each.
    for (Index at = list.b_begin; at < list.b_end; at += kAtOnce) {
      Index c[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) c[j] = at + j < list.b_end ? p_.b_contact[at + j] : -1;
      Pull pulls[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        if (c[j] >= 0) pulls[j] = of_any(c[j]);
      }
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) sum.add_as_b(pulls[j]);
    }
    return sum;
  }
  /// The same by a warp; every lane gets the sum.
  __device__ Wrench<Real> by_warp(const Lists& list) const {
    const auto lane = static_cast<Index>(threadIdx.x % 32);
    Wrench<Real> sum;
    for (Index c = list.a_begin + lane; c < list.a_end; c += 32) sum.add_as_a(of_tile(c));
    for (Index at = list.b_begin + lane; at < list.b_end; at += 32)
      sum.add_as_b(of_any(p_.b_contact[at]));
    sum.add_over_warp();
    return sum;
  }

 private:
  using Pull = typename Tile<Real>::Pull;

  /// Of a contact of the tile, nearly always in shared memory.
  __device__ Pull of_tile(Index c) const {
    const Index slot = c - first_;
    if (slot < kStaged) return tile_.pull[slot];
    return {gamma_[c], p_.normal[c]};
  }
  /// Of any contact: one kind of load, so that several can be under way.
  __device__ Pull of_any(Index c) const {
    const unsigned slot = static_cast<unsigned>(c - first_);
    return {*(slot < kStaged ? &tile_.pull[slot].impulse : gamma_ + c),
            *(slot < kStaged ? &tile_.pull[slot].normal : p_.normal.data + c)};
  }

  const ContactProblem<Real>& p_;
  const Vec3<Real>* const gamma_;
  const Index first_;
  const Tile<Real>& tile_;
};

/// Body pass of a tile, one body a thread; a body with many contacts is summed up by its warp.
template <class Real>
__device__ void step_bodies(const RadialPasses<Real>& a, TileRange range, const Tile<Real>& tile,
                            Sums<3>& sums) {
  using R = RadialRows<Real>;
  const Index i = range.begin + static_cast<Index>(threadIdx.x);
  const bool is_there = i < range.end;
  const Gather<Real> gather(a, range, tile);
  Lists lists;
  if (is_there) lists = gather.lists(i);
  const bool is_long = lists.size() > kLongList;
  Wrench<Real> wrench;
  if (!is_long) wrench = gather.by_thread(lists);
  for (unsigned left = __ballot_sync(0xffffffffu, is_long); left != 0; left &= left - 1) {
    const int of = __ffs(static_cast<int>(left)) - 1;
    const auto lane = static_cast<int>(threadIdx.x % 32);
    const Wrench<Real> sum = gather.by_warp(gather.lists(i - lane + of));
    if (lane == of) wrench = sum;
  }
  if (!is_there) return;
  const ApgdState& s = *a.state;
  const Index k = s.accepted;
  const Twist<Real> next = a.p.free_velocity[i] +
                           R::apply_inverse_mass(a.p, i, Twist<Real>{wrench.force, wrench.torque});
  const Twist<Real> momentum = static_cast<Real>(s.next_beta) * (next - a.velocity.current(s)[i]);
  a.velocity.iterate(k + 1)[i] = next;
  a.velocity.extrapolated(k + 1)[i] = next + momentum;
  const Twist<Real> change = next - tile.extrapolated[threadIdx.x];
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
               unsigned first_trial, int count) {
  extern __shared__ __align__(16) unsigned char bytes[];
  Tile<Real>* const tile = reinterpret_cast<Tile<Real>*>(bytes);
  const Index blocks = static_cast<Index>(gridDim.x);
  const auto range_of = [&](Index t) {
    TileRange range;
    range.begin = t * kBodies;
    range.end = min(range.begin + kBodies, a.p.free_count);
    range.first = a.p.a_start[range.begin];
    range.last = a.p.a_start[range.end];
    return range;
  };
  for (unsigned trial = first_trial; trial < first_trial + count; ++trial) {
    const ApgdContactStep<RadialRows<Real>, Real> step = a.contact_pass().step();
    Sums<3> sums;
    Index round = 0;
    for (Index t = static_cast<Index>(blockIdx.x); t < tiles + blocks; t += blocks, ++round) {
      if (t < tiles) step_contacts(a, step, range_of(t), tile[round & 1], sums);
      __syncthreads();
      if (threadIdx.x == 0) {
        if (t < tiles)
          DeviceCounter(shared.round_done[round]).fetch_add(1, cuda::memory_order_release);
        if (round > 0) {
          const Index before = min(blocks, tiles - (round - 1) * blocks);
          wait_for(shared.round_done[round - 1], (trial + 1) * static_cast<unsigned>(before));
        }
      }
      __syncthreads();
      if (round == 0) continue;
      step_bodies(a, range_of(t - blocks), tile[(round - 1) & 1], sums);
    }
    decide(a, shared, trial, sums);
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
    trials_ = 0;
  }

  template <class R, class Real>
  void run(Cuda& cuda, const ApgdPasses<R, Real>& a, int count) {
    for (int k = 0; k < count; ++k) apgd_trial(cuda, a);
  }

  void run(Cuda& cuda, const sweep::RadialPasses<float>& a, int count) {
    sweep::RadialPasses<float> passes = a;
    void* arguments[] = {&passes, &shared_, &tiles_, &trials_, &count};
    check_cuda(cudaLaunchCooperativeKernel(kernel(), blocks_, sweep::kThreads, arguments, kBytes,
                                           cuda.stream()),
               "apgd_sweep");
    cuda.check_launch("apgd_sweep");
    trials_ += static_cast<unsigned>(count);
  }

 private:
  static constexpr int kBytes = 2 * sizeof(sweep::Tile<float>);

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
  unsigned trials_ = 0;
};

}  // namespace scree
