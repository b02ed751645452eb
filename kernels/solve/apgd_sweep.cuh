#pragma once
// Tuned twin of the two APGD passes for the radial and the mixed layout: one cooperative launch runs
// many trials.
//
// A block takes tiles of bodies that are neighbors in space (Morton order), one in each round. It
// brings their V_y into shared memory while the tile before is at work, steps their contacts, keeps
// what the new impulses exert in shared memory too, and sums up there what contacts within the tile
// exert. Only contacts with bodies outside the tile go through global memory: as B of a lower body,
// whose tile has its contact step in the same round or an earlier one. So the body pass of a round
// runs after the contact step of the next one, when that of its own round is done everywhere, and
// rarely waits. A large body among small ones has thousands of contacts, which all threads of a
// warp sum up. At the end of a trial the blocks meet, each adds up the sums of all in block order
// and decides, and the next trial begins without a launch.
//
// General contacts of the mixed layout are few. All threads take their share of them first thing in a
// trial, before any tile: so these are done where the contact steps of the first round are, and no
// body moves before. Bodies add what they exert by lists of their own.
//
// The warps of a block meet nowhere within a trial: barriers are in halves, with other work between
// (SplitBarrier). One warp speaks with other blocks; it has the fewest contacts and bodies.
//
// Bytes from memory per contact (float, uniform bodies): normal, metric and A packed 8, bias 4,
// B 4, two impulses 24, list 4 read, impulse 12 written. Per body: v*, two V 72, inertia 8,
// starts 8 read, V 24 written: 280 MB for 1e6 bodies with 3e6 contacts, where the plain passes
// take 427. Far contacts and sectors read in part make that 410 MB between the cache levels,
// and the link between the two halves of the second-level cache, which half of it crosses,
// is nearly as busy as in a copy (bench/results/h200). The first-level cache is short:
// a stack of 32 bytes a thread, for registers that were spilled, cost a tenth of the time,
// and shared memory is dear too.
// Problems that fit into shared memory as a whole take another program (apgd_resident.cuh).
// Where ranks share a problem, each on a GPU of its own, the blocks of all of them meet (rank_meeting.cuh); that is one more
// program.
// Sums are those of the plain passes in another order: the same bits on every run of one device.
// Doubles take the plain passes, which are faster for them.

#include <algorithm>
#include <utility>

#include "kernels/backend/split_barrier.cuh"
#include "kernels/solve/apgd_decide.cuh"
#include "kernels/solve/apgd_general.cuh"
#include "kernels/solve/apgd_resident.cuh"
#include "kernels/solve/apgd_tile.cuh"
#include "kernels/solve/apgd_wide.cuh"
#include "kernels/solve/rank_meeting.cuh"

namespace scree {
namespace apgd_sweep {

/// What the blocks share, in device memory. All of it starts at zero with a solve.
struct Shared {
  unsigned* round_done;         ///< [rounds] contact steps done, over all trials
  ApgdMeeting meeting;          ///< at the end of a trial
  unsigned* taken;              ///< blocks that took what ranks sent, over all trials
  const PackedContact* packed;  ///< [contacts]
};

/// Body pass of the thread's body of a tile: what other tiles exert, then its new velocity. A body
/// with many contacts is summed up by its warp.
/// @tparam kIsMixed  there are general contacts, and maybe bodies that are no spheres
template <bool kIsMixed, class Real>
__device__ void step_body(const RadialPasses<Real>& a, const Trial<Real>& trial, Index i,
                          bool is_there, PartialWrench<Real>& body, const Twist<Real>& extrapolated,
                          Sums<3>& sums) {
  const Gather<Real> gather(a, trial);
  const bool is_long = is_there && body.is_long();
  if (is_there) gather.add_far(body);
  for (unsigned left = __ballot_sync(0xffffffffu, is_long); left != 0; left &= left - 1) {
    const int of = __ffs(static_cast<int>(left)) - 1;
    const auto lane = static_cast<int>(threadIdx.x % 32);
    const Wrench<Real> sum = gather.by_warp(i - lane + of);
    if (lane == of) body.wrench = sum;
  }
  if constexpr (kIsMixed) add_general(a.p, trial.next_gamma.data, i, is_there, body.wrench);
  if (is_there)
    trial.next_velocity[i] =
        moved_body<kIsMixed>(a.p, i, BodyBefore<Real>(a.p, i), body.wrench, extrapolated, sums);
}

/// In place of GhostLinks, where one rank has all bodies.
struct NoLinks {};

/// @tparam Links  GhostLinks, or NoLinks
template <int kWeights, Law kLaw, bool kIsMixed, class Links, class Real>
__global__ void __launch_bounds__(kThreads, kBlocks)
    run_trials(const __grid_constant__ RadialPasses<Real> a, const Shared shared, Index tiles,
               int count, double enough, const __grid_constant__ Links links) {
  constexpr bool kIsOverRanks = std::is_same_v<Links, GhostLinks>;
  extern __shared__ __align__(16) unsigned char bytes[];
  TileMemory<Real>& memory = *reinterpret_cast<TileMemory<Real>*>(bytes);
  __shared__ SplitBarrier ready;  // V_y of a tile is there, the pulls of the one before are summed
  __shared__ SplitBarrier stepped;  // the contact step of a tile is done
  __shared__ SplitBarrier reached;  // other blocks are done with the round before
  __shared__ ApgdState state;       // the same in all blocks
  __shared__ unsigned trials;       // before this launch: no block arrives before all know
  __shared__ unsigned meetings;     // of ranks, before this launch
  const auto blocks = static_cast<Index>(gridDim.x);
  const auto local = static_cast<Index>(threadIdx.x);
  const bool is_speaker = local == kThreads - 32;
  if (local == 0) {
    ready.init(kThreads);
    stepped.init(kThreads);
    reached.init(1);
    state = *a.state;
    trials = *shared.meeting.arrived / gridDim.x;
    if constexpr (kIsOverRanks) meetings = links.board[links.rank]->meetings;
  }
  __syncthreads();
  const FirstFetch<Real> first(a, static_cast<Index>(blockIdx.x));
  {
    const Trial<Real> trial(a, state, shared.packed);
    first.start(trial.velocity, trial.previous_velocity, memory.bodies);
  }
  unsigned turn = 0;  // tiles so far: phases of `stepped`
  unsigned k = 0;
  for (; k < static_cast<unsigned>(count); ++k) {
    if (k > 0 && !(state.measure > enough)) break;
    const Trial<Real> trial(a, state, shared.packed);
    const unsigned number = trials + k;
    const Index accepted = state.accepted;
    const Gather<Real> gather(a, trial);
    Sums<3> sums;
    auto t = static_cast<Index>(blockIdx.x);
    first.finish(trial, memory.bodies);
    ready.arrive();
    if constexpr (kIsMixed) step_general_contacts<kLaw>(a, trial, sums);
    for (Index round = 0;; t += blocks, ++round) {
      const TileBodies<Real>& here = memory.bodies[round % 2];
      TileBodies<Real>& other = memory.bodies[(round + 1) % 2];
      const bool has_tile = t < tiles;
      ready.wait((turn + k) % 2);  // one more than tiles in each trial
      // Now that no warp waits for `reached` of the round before, its next phase may end.
      if (is_speaker && round > 0) {
        const Index done = min(blocks, tiles - (round - 1) * blocks);
        wait_for(shared.round_done[round - 1], (number + 1) * static_cast<unsigned>(done));
        reached.arrive();
      }
      __syncwarp();
      TileRange range;
      if (has_tile) {
        range.begin = t * kBodies;
        range.count = min(Index{kBodies}, a.p.bodies.owned_count - range.begin);
        range.first = here.a_start[0];
        range.last = here.a_start[range.count];
        step_contacts<kWeights, kLaw>(a, trial, range, here, memory.pull, sums);
        stepped.arrive();
      }
      const Index i = (t - blocks) * kBodies + local;
      const bool is_before = round > 0 && local < kBodies && i < a.p.bodies.owned_count;
      Twist<Real> extrapolated;
      if (is_before) extrapolated = other.extrapolated[local];
      BodyFetch<Real> fetch(a, trial, t + blocks);
      const bool has_next = t + blocks < tiles;
      if (has_next) fetch.start(a, other);
      if (is_speaker && has_tile) {
        stepped.wait(turn % 2);
        DeviceCounter(shared.round_done[round]).fetch_add(1, cuda::memory_order_release);
      }
      __syncwarp();
      if (round > 0) {
        reached.wait((turn - 1) % 2);
        PartialWrench<Real> body;
        if (is_before) body = memory.half_done[local];
        step_body<kIsMixed>(a, trial, i, is_before, body, extrapolated, sums);
      }
      if (has_next) fetch.read_previous();
      if (has_tile) {
        stepped.wait(turn % 2);
        if (local < range.count) memory.half_done[local] = gather.within(range, here, memory.pull);
      }
      if (has_next) fetch.finish(other);
      if (!has_tile) break;
      ++turn;
      ready.arrive();
    }
    // Nearly all trials are accepted.
    Sums<3> all = meet_blocks(shared.meeting, number, sums, [&] {
      first.start(trial.next_velocity, trial.velocity, memory.bodies);
    });
    if constexpr (kIsOverRanks) {
      // Pulls are summed up by now.
      static_assert(sizeof(RankNotes) <= sizeof(memory.pull));
      auto* notes = reinterpret_cast<RankNotes*>(memory.pull);
      if (local == 0) notes->sums = all;
      meet_ranks(&links, shared.taken, meetings + k + 1, number + 1, notes,
                 a.velocity.iterate(state.accepted + 1).data);
      all = notes->sums;
    }
    decide(all, state, kLaw == Law::coulomb);
    if (state.accepted == accepted) {
      const Span<const Twist<Real>> same = a.velocity.iterate(state.accepted);
      first.restart(same, same, memory.bodies);
    }
  }
  __pipeline_wait_prior(0);
  if (blockIdx.x == 0 && local == 0) {
    *a.state = state;
    if constexpr (kIsOverRanks) links.board[links.rank]->meetings = meetings + k;
  }
}

/// The sums of one block.
struct ReadPartial {
  static constexpr const char* name = "apgd_read_partial";
  Span<const Sums<3>> partial;
  SCREE_HD Sums<3> operator()(Index k) const { return partial[k]; }
};

}  // namespace apgd_sweep

/// A trial of one of several ranks, whose sums are those of its share.
template <class R, class Real>
void apgd_shared_trial(Cuda& b, const ApgdPasses<R, Real>& a, ApgdSums* sums) {
  reduce<Sums<2>>(
      b, a.p.contact_count,
      CountedOnce<ApgdContactPass<R, Real>>{a.contact_pass(), a.p.body_a, a.p.body_b, a.p.bodies},
      StoreResult<Sums<2>>{&sums->contacts});
  reduce<Sums<1>>(b, a.p.bodies.owned_count, a.body_pass(), StoreResult<Sums<1>>{&sums->bodies});
}

template <>
class ApgdIteration<Cuda> {
 public:
  explicit ApgdIteration(Cuda& cuda)
      : counters_(cuda), partial_(cuda), packed_(cuda), resident_(cuda), wide_(cuda), sums_(cuda) {}

  template <class R, class Real>
  void start(Cuda& cuda, const ApgdPasses<R, Real>& a, const Ghosts<Cuda>* ghosts = nullptr) {
    ghosts_ = nullptr;
    tiles_ = 0;
    is_counted_ = is_resident_ = false;
    if constexpr (kIsSwept<R, Real>) {
      if (ghosts != nullptr && ghosts->links() != nullptr && kernel_over_ranks(a) != nullptr) {
        ghosts_ = ghosts;
        start_sweep(cuda, a, kernel_over_ranks(a));
        return;
      }
    }
    if constexpr (kHasPrograms<R, Real>) {
      if (a.p.bodies.owned_count == 0) return;  // of one of several ranks
      is_counted_ = cuda.ranks() == nullptr && resident_.start(cuda, a);
      if (!is_counted_) start_large(cuda, a);
    }
  }

  template <class R, class Real>
  bool stops(const ApgdPasses<R, Real>&) const {
    return kHasPrograms<R, Real>;
  }
  template <class R, class Real>
  bool stores_extrapolated(const ApgdPasses<R, Real>&) const {
    return !kIsSwept<R, Real>;
  }

  bool meets_ranks() const { return ghosts_ != nullptr; }

  template <class R, class Real>
  void run(Cuda& cuda, const ApgdPasses<R, Real>& a, int count, double enough) {
    if constexpr (kHasPrograms<R, Real>) {
      if (std::exchange(is_counted_, false)) {
        is_resident_ = resident_.fits(cuda);
        if (!is_resident_) start_large(cuda, a);
      }
      if (is_resident_) {
        resident_.run(cuda, passes_on<RadialRows<Real>>(a), count, enough);
        return;
      }
    }
    if constexpr (kIsSwept<R, Real>) {
      // A thread whose call waits for its GPU must not keep another one from launching what that GPU waits for.
      const bool has_threads = ghosts_ != nullptr && ghosts_->has_threads();
      if (has_threads) any(*cuda.ranks(), false);
      // The law of the sweep tells impacts from other contacts.
      sweep(cuda, passes_on<RadialRows<Real>>(a), count, enough);
      if (has_threads) any(*cuda.ranks(), false);
    } else if constexpr (kIsWide<R>) {
      wide_.run(cuda, a, count, enough);
    } else {
      for (int k = 0; k < count; ++k) apgd_trial(cuda, a);
    }
  }

  /// The sweep decides by the sums here; the caller overwrites the state that it leaves.
  template <class R, class Real>
  void queue_trial(Cuda& cuda, const ApgdPasses<R, Real>& a) {
    if constexpr (kIsSwept<R, Real>) {
      if (tiles_ > 0) sweep(cuda, passes_on<RadialRows<Real>>(a), 1, -1);
    } else {
      apgd_shared_trial(cuda, a, sums_.resize_discard(1).data);
    }
  }
  template <class R, class Real>
  ApgdSums take_sums(Cuda& cuda, const ApgdPasses<R, Real>&) {
    if constexpr (!kIsSwept<R, Real>) {
      return fetch(cuda, std::as_const(sums_).data());
    } else {
      if (tiles_ == 0) return {};
      auto* result = static_cast<Sums<3>*>(cuda.result());
      reduce<Sums<3>>(cuda, static_cast<Index>(blocks_),
                      apgd_sweep::ReadPartial{std::as_const(partial_).view(blocks_)},
                      StoreResult<Sums<3>>{result});
      cuda.synchronize();
      return {{{result->value[0], result->value[1]}}, {{result->value[2]}}};
    }
  }

 private:
  /// Programs for any number of bodies.
  template <class R, class Real>
  void start_large(Cuda& cuda, const ApgdPasses<R, Real>& a) {
    if constexpr (kIsSwept<R, Real>) {
      start_sweep(cuda, a, kernel_of(a));
    } else if (cuda.ranks() == nullptr) {
      wide_.start(cuda, a);
    }
  }
  template <class R, class Real>
  void start_sweep(Cuda& cuda, const ApgdPasses<R, Real>& a, const void* kernel) {
    kernel_ = kernel;
    tiles_ = (a.p.bodies.owned_count + apgd_sweep::kBodies - 1) / apgd_sweep::kBodies;
    blocks_ = std::clamp<unsigned>(tiles_, 1, resident_blocks(cuda));
    constexpr int kMeetings = 2;
    const Offset counters = kMeetings + Offset{tiles_} / blocks_ + 1;
    counters_.reserve_discard(counters);
    partial_.reserve_discard(blocks_);
    fill(cuda, counters_.view(counters), 0u);
    const Index radial = apgd_sweep::kIsMixed<R, Real> ? a.p.radial_count : a.p.contact_count;
    packed_.reserve_discard(radial);
    for_each(cuda, radial, apgd_sweep::PackContacts<R, Real>{a.p, a.metric, packed_.view(radial)});
    unsigned* counter = counters_.data();
    shared_ = {counter + kMeetings, {counter, partial_.data()}, counter + 1, packed_.data()};
  }
  void sweep(Cuda& cuda, apgd_sweep::RadialPasses<float> passes, int count, double enough) {
    apgd_sweep::NoLinks none;
    GhostLinks links;
    if (ghosts_ != nullptr) links = *ghosts_->links();
    void* to_links = ghosts_ != nullptr ? static_cast<void*>(&links) : &none;
    void* arguments[] = {&passes, &shared_, &tiles_, &count, &enough, to_links};
    check_cuda(cudaLaunchCooperativeKernel(kernel_, blocks_, apgd_sweep::kThreads, arguments,
                                           kBytes, cuda.stream()),
               "apgd_sweep");
    cuda.check_launch("apgd_sweep");
  }

  /// Doubles take the plain passes, which are faster for them.
  template <class R, class Real>
  static constexpr bool kIsSwept = std::is_same_v<Real, float> &&
                                   (std::is_same_v<R, RadialRows<Real>> ||
                                    std::is_same_v<R, MixedRows<Real>> ||
                                    apgd_sweep::kIsImpact<R, Real>);
  template <class R>
  static constexpr bool kIsWide = std::is_same_v<R, wide::Rows>;
  template <class R, class Real>
  static constexpr bool kHasPrograms = kIsSwept<R, Real> || kIsWide<R>;
  static constexpr int kBytes = sizeof(apgd_sweep::TileMemory<float>);

  /// The program of ranks that meet in it; null where there is none: impacts, which are few, take a trial at a time.
  template <class R>
  static const void* kernel_over_ranks(const ApgdPasses<R, float>& a) {
    if constexpr (apgd_sweep::kIsImpact<R, float>) {
      return nullptr;
    } else {
      if (a.exact) return nullptr;
      return apgd_sweep::sweep_program_over_ranks(a.metric.one_each ? 1 : 2,
                                                  apgd_sweep::kIsMixed<R, float>);
    }
  }
  /// Loads behind a branch would start late, so there is a program for each way to store weights.
  template <class R>
  static const void* kernel_of(const ApgdPasses<R, float>& a) {
    const int weights = a.metric.values.empty() ? 0 : a.metric.one_each ? 1 : 2;
    return apgd_sweep::sweep_program(weights, apgd_sweep::law_of<R>(a.exact),
                                     apgd_sweep::kIsMixed<R, float>);
  }
  /// Blocks wait for each other, so all must be on the device at once.
  unsigned resident_blocks(const Cuda& cuda) const {
    check_cuda(cudaFuncSetAttribute(kernel_, cudaFuncAttributeMaxDynamicSharedMemorySize, kBytes),
               "shared memory of apgd_sweep");
    return cuda.resident_blocks(kernel_, "occupancy of apgd_sweep", kBytes);
  }

  Buffer<Cuda, unsigned> counters_;  ///< arrived, taken, round_done
  Buffer<Cuda, Sums<3>> partial_;
  Buffer<Cuda, PackedContact> packed_;
  apgd_sweep::ResidentTrials resident_;
  wide::Iteration wide_;
  Buffer<Cuda, ApgdSums> sums_;  ///< of one of several ranks, by the plain passes
  apgd_sweep::Shared shared_{};
  const void* kernel_ = nullptr;
  const Ghosts<Cuda>* ghosts_ = nullptr;  ///< of ranks that meet in the program
  Index tiles_ = 0;
  unsigned blocks_ = 0;
  bool is_counted_ = false;   ///< resident_ counts; the first trials tell whether tiles fit
  bool is_resident_ = false;  ///< they do
};

}  // namespace scree
