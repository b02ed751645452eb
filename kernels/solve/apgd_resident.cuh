#pragma once
// APGD of few bodies: one launch runs many trials, and what they change stays in shared memory all the while.
//
// Each multiprocessor has one block, and that a tile of bodies that are neighbors in space (Morton order), with all of
// their contacts (resident_tile.cuh). A contact between two tiles is stepped in both, so a trial has one meeting of the
// blocks, at its end: there they tell their sums and the new V of their bodies. In the sweep (apgd_sweep.cuh) they meet
// twice, and load from the second-level cache what is at hand here.
//
// Shared memory (float): a contact of spheres takes 50 bytes, one with lever arms in a layout of such alone 30; a body
// 28, and one of the halo, which is outside and has contacts with one inside, 52. On an H100 110,000 spheres with 2.7
// contacts each fit, or as many boxes with five. Through the second-level cache come V of a body, 24 bytes, that of the
// halo, and v* and mass of a body, 32; V written is 24. With lever arms alone it is 80 a contact and 56 a body more
// (resident_contacts.cuh).
//
// Sums are those of the plain passes in another order: the same bits on every run of one device.

#include <algorithm>

#include "kernels/solve/apgd_decide.cuh"
#include "kernels/solve/apgd_general.cuh"
#include "kernels/solve/block_board.cuh"
#include "kernels/solve/resident_contacts.cuh"

namespace scree {
namespace apgd_sweep {

/// Where all that a block has lies in its shared memory [bytes].
struct TileLayout {
  unsigned counts = 0;  ///< of contacts of either group, and of bodies in the halo
  unsigned extrapolated = 0, halo_velocity = 0, halo_body = 0;
  unsigned set_size = 0;  ///< of the BodySet that lies where V_y will be
  ContactsLayout group[kGroups];
  OwnValues own;
  Index bodies = 0;              ///< of a tile
  Index contacts[kGroups] = {};  ///< the most of any tile
  unsigned image_bytes = 0;      ///< the first ones, which stay through a solve
  unsigned bytes = 0;
};

/// What the blocks share, in device memory. The counters start at zero with a solve.
struct ResidentShared {
  BlockBoard board;      ///< a round for each trial
  unsigned* trials;      ///< of all launches before
  unsigned* waiting;     ///< at a barrier without sums
  unsigned* generation;  ///< of that barrier
  const Index* cut;      ///< of cut_tiles()
  float4* records;       ///< of StreamedContacts, [blocks * tile_records]
  Index tile_records;
  Index* far_number;  ///< of list_contacts(), [blocks * (contacts of all groups)]
  float4* image;      ///< [blocks * image_bytes / 16] lists for later launches of a solve, or null
};

/// Waits for all blocks; none goes through twice before all went once.
__device__ inline void meet_without_sums(const ResidentShared& shared) {
  __syncthreads();
  if (threadIdx.x == 0) {
    DeviceCounter generation(*shared.generation), waiting(*shared.waiting);
    const unsigned now = generation.load(cuda::memory_order_relaxed);
    if (waiting.fetch_add(1, cuda::memory_order_acq_rel) == gridDim.x - 1) {
      waiting.store(0, cuda::memory_order_relaxed);
      generation.store(now + 1, cuda::memory_order_release);
    } else {
      spin_until(*shared.generation, now + 1);
    }
    acquire();
  }
  __syncthreads();
}

/// Steps all contacts of a group.
/// @param v_y  of the bodies of the tile and of its halo
template <bool kHasOwn, Law kLaw, class Contacts>
__device__ void step_group(const RadialPasses<float>& a, const ResidentTrial& trial,
                           const Contacts& contacts, const Twist<float>* v_y, Sums<3>& sums) {
  for (auto k = static_cast<Index>(threadIdx.x); k < contacts.all; k += block_threads()) {
    const Ends ends = contacts.ends(k);
    Twist<float> v_a = load_by<float2>(v_y + ends.inside());
    Twist<float> v_b = load_by<float2>(v_y + ends.other());
    const bool is_own = k < contacts.own;
    if (!is_own) {
      const Twist<float> inside = v_a;
      v_a = v_b;
      v_b = inside;
    }
    const Sums<2> mine = contacts.template step<kHasOwn, kLaw>(a, trial, k, v_a, v_b);
    if (!is_own) continue;  // the tile of A counts it
    sums.value[0] += mine.value[0];
    sums.value[1] += mine.value[1];
  }
}

/// Adds what the contacts of one group exert on body i of the tile, shared by a number of threads.
template <class Contacts>
__device__ void add_contacts(const Contacts& contacts, const ResidentTrial& trial, Index i,
                             int thread, int threads, Wrench<float>& sum) {
  // Two at a time, so that a load waits for another one half as often.
  const auto add_two = [&](Index first, Index second, bool side_b) {
    const bool has_second = second >= 0;
    typename Contacts::Pulled x, y;
    contacts.pull(trial, first, side_b, x);
    if (has_second) contacts.pull(trial, second, side_b, y);
    contacts.add(x, side_b, sum);
    if (has_second) contacts.add(y, side_b, sum);
  };
  const int a_end = contacts.a_begin[i + 1], b_end = contacts.b_begin[i + 1];
  for (int k = contacts.a_begin[i] + thread; k < a_end; k += 2 * threads)
    add_two(k, k + threads < a_end ? k + threads : -1, false);
  for (int at = contacts.b_begin[i] + thread; at < b_end; at += 2 * threads)
    add_two(contacts.b_contact[at],
            at + threads < b_end ? Index{contacts.b_contact[at + threads]} : -1, true);
}

/// @tparam kLayout  radial, mixed or general
/// @tparam kHasOwn  contacts may have OwnValues
template <ContactLayout kLayout, Law kLaw, bool kHasOwn>
__global__ void __launch_bounds__(kResidentThreads, 1)
    run_resident_trials(const __grid_constant__ RadialPasses<float> a,
                        const __grid_constant__ TileLayout layout,
                        const __grid_constant__ ResidentShared shared, int count, double enough) {
  constexpr bool kIsMixed = kLayout == ContactLayout::mixed;
  constexpr bool kIsGeneral = kLayout == ContactLayout::general;
  using Contacts = std::conditional_t<kIsGeneral, StreamedContacts, RadialContacts>;
  using Body = std::conditional_t<kIsGeneral, GeneralBody, BodyBefore<float>>;
  extern __shared__ __align__(16) unsigned char bytes[];
  __shared__ ApgdState state;  // the same in all blocks
  __shared__ unsigned trials;  // before this launch
  __shared__ Sums<3> told[kResidentWarps], heard[kResidentWarps];
  const auto first_body = static_cast<Index>(threadIdx.x);
  if (threadIdx.x == 0) {
    state = *a.state;
    trials = *shared.trials;
  }
  __syncthreads();
  const TileOfBodies tile(shared.cut, blockIdx.x);
  Twist<float>* v_y;     // V_y, in the end of a trial V of the next iterate; then V_y of the halo
  Twist<float>* halo_v;  // V of the iterate
  Index* halo_body;
  point(v_y, bytes, layout.extrapolated);
  point(halo_v, bytes, layout.halo_velocity);
  point(halo_body, bytes, layout.halo_body);
  Contacts contacts = [&] {
    if constexpr (kIsGeneral) {
      return Contacts(bytes, layout.group[0], layout.own,
                      shared.records + static_cast<Offset>(blockIdx.x) * shared.tile_records,
                      layout.contacts[0]);
    } else {
      return Contacts(bytes, layout.group[0], layout.own);
    }
  }();
  GeneralContacts general(bytes, layout.group[1], layout.own);
  Index* const far_number = shared.far_number + static_cast<Offset>(blockIdx.x) *
                                                    (layout.contacts[0] + layout.contacts[1]);
  Index* const far_general = far_number + layout.contacts[0];
  int* counts;
  point(counts, bytes, layout.counts);
  const ContactLists lists = a.p.lists(0), general_lists = kIsMixed ? a.p.lists(1) : lists;
  contacts.take_range(lists, tile);
  if constexpr (kIsMixed) general.take_range(general_lists, tile);
  const auto image_records = layout.image_bytes / static_cast<unsigned>(sizeof(float4));
  float4* const image =
      shared.image == nullptr
          ? nullptr
          : shared.image + static_cast<Offset>(blockIdx.x) * static_cast<Offset>(image_records);
  auto* const records = reinterpret_cast<float4*>(bytes);
  const bool is_first = image == nullptr || trials == 0;
  if (is_first) {
    BodySet outside{nullptr, layout.set_size};
    point(outside.place, bytes, layout.extrapolated);
    outside.clear();
    __syncthreads();
    list_contacts(a.p, lists, tile, outside, far_number, contacts);
    if constexpr (kIsMixed) list_contacts(a.p, general_lists, tile, outside, far_general, general);
    const Index numbered = number_bodies(outside, halo_body);
    name_outside(outside, layout.bodies, contacts);
    if constexpr (kIsMixed) name_outside(outside, layout.bodies, general);
    if (threadIdx.x == 0) {
      counts[0] = contacts.all;
      counts[1] = general.all;
      counts[2] = numbered;
    }
  } else {
    for (unsigned k = threadIdx.x; k < image_records; k += blockDim.x) records[k] = image[k];
  }
  __syncthreads();
  contacts.all = counts[0];
  general.all = counts[1];
  const Index halo = counts[2];
  load_contacts(a, lists, far_number, is_first, contacts);
  if constexpr (kIsMixed) load_contacts(a, general_lists, far_general, is_first, general);
  if (is_first && image != nullptr) {
    __syncthreads();
    for (unsigned k = threadIdx.x; k < image_records; k += blockDim.x) image[k] = records[k];
  }
  // V of the iterate as a trial leaves it, and V of the iterate before.
  Span<const Twist<float>> velocity = a.velocity.iterate(state.accepted);
  Span<const Twist<float>> previous = a.velocity.iterate(state.accepted + 1);
  for (Index i = first_body; i < tile.count; i += block_threads())
    store_by<float2>(load_by<float2>(velocity.data + tile.begin + i), v_y + i);
  for (Index h = first_body; h < halo; h += block_threads())
    store_by<float2>(load_by<float2>(previous.data + halo_body[h]), halo_v + h);
  __syncthreads();
  // Of the thread's first body, V of the iterate before; of its first one in the halo, V of the iterate. The last
  // threads have no body, or one less than others.
  const Index first_halo = block_threads() - 1 - first_body;
  Twist<float> own_before, halo_now;
  const auto look_ahead = [&] {
    if (first_body < tile.count)
      own_before = load_by<float2>(previous.data + tile.begin + first_body);
    if (first_halo < halo) halo_now = load_by<float2>(velocity.data + halo_body[first_halo]);
  };
  look_ahead();
  const bool has_general = kIsMixed && general.all > 0;
  meet_without_sums(shared);  // trials overwrite V that other blocks have been reading
  bool is_new = true;         // the iterate is not that of the trial before
  unsigned number = trials;   // of the trial
  for (;; ++number) {
    const ResidentTrial trial(state);
    const Index accepted = state.accepted;
    for (Index i = first_body; i < tile.count; i += block_threads()) {
      Twist<float> before = own_before;
      if (i >= block_threads()) before = load_by<float2>(previous.data + tile.begin + i);
      if (is_new) before = trial.extrapolated(load_by<float2>(v_y + i), before);
      store_by<float2>(before, v_y + i);
    }
    for (Index h = first_halo; h < halo; h += block_threads()) {
      Twist<float> v = load_by<float2>(halo_v + h);
      if (is_new) {
        Twist<float> now = halo_now;
        if (h >= block_threads()) now = load_by<float2>(velocity.data + halo_body[h]);
        store_by<float2>(now, halo_v + h);
        v = trial.extrapolated(now, v);
      }
      store_by<float2>(v, v_y + layout.bodies + h);
    }
    __syncthreads();
    Sums<3> sums;
    step_group<kHasOwn, kLaw>(a, trial, contacts, v_y, sums);
    if (has_general) step_group<kHasOwn, kLaw>(a, trial, general, v_y, sums);
    Body before;
    if (first_body < tile.count) before = Body(a.p, tile.begin + first_body);
    __syncthreads();

    const Span<Twist<float>> to = a.velocity.iterate(accepted + 1);
    for_all_threads(tile.count, [&](Index i, bool is_there) {
      Wrench<float> wrench;
      const auto add = [&](Index body, int thread, int threads, Wrench<float>& sum) {
        add_contacts(contacts, trial, body, thread, threads, sum);
        if (has_general) add_contacts(general, trial, body, thread, threads, sum);
      };
      const bool is_long =
          is_there && contacts.count(i) + (has_general ? general.count(i) : 0) > kLongList;
      if (is_there && !is_long) add(i, 0, 1, wrench);
      const auto lane = static_cast<int>(threadIdx.x % 32);
      for (unsigned left = __ballot_sync(0xffffffffu, is_long); left != 0; left &= left - 1) {
        const int of = __ffs(static_cast<int>(left)) - 1;
        Wrench<float> sum;
        add(i - lane + of, lane, 32, sum);
        sum.add_over_warp();
        if (lane == of) wrench = sum;
      }
      if (!is_there) return;
      const Index body = tile.begin + i;
      if (i >= block_threads()) before = Body(a.p, body);
      const Twist<float> extrapolated = load_by<float2>(v_y + i);
      const Twist<float> next = moved_body<kIsMixed>(a.p, body, before, wrench, extrapolated, sums);
      store_by<float2>(next, v_y + i);
      store_by<float2>(next, to.data + body);
    });

    shared.board.tell(number, sums, told);
    if (threadIdx.x == 0) {
      state.foresee(ApgdBodyFinish::decay(kLaw == Law::coulomb));
      shared.board.wait(number);
    }
    __syncthreads();
    previous = a.velocity.iterate(accepted);
    velocity = to;
    look_ahead();  // as if the trial were accepted; if not, `previous` has V of the iterate
    shared.board.read(number, heard);
    __syncthreads();
    if (threadIdx.x == 0)
      decide_alone(BlockBoard::added_up(heard), state, kLaw == Law::coulomb, true);
    __syncthreads();
    is_new = state.accepted != accepted;
    if (number + 1 - trials >= static_cast<unsigned>(count) || !(state.measure > enough)) break;
    // The next trial overwrites what others may still be looking ahead at.
    if (!is_new) meet_without_sums(shared);
  }
  store_impulses(a.gamma, 0, contacts);
  if constexpr (kIsMixed) store_impulses(a.gamma, a.p.radial_count, general);
  if (blockIdx.x == 0 && threadIdx.x == 0) {
    state.foresee(ApgdBodyFinish::decay(kLaw == Law::coulomb));
    *a.state = state;
    *shared.trials = number + 1;
  }
}

/// The trials of a solve whose bodies and contacts fit into the shared memory of a device.
class ResidentTrials {
 public:
  explicit ResidentTrials(Cuda& cuda)
      : counters_(cuda),
        told_(cuda),
        records_(cuda),
        image_(cuda),
        cut_(cuda),
        far_numbers_(cuda) {}

  /// Counts what tiles have. @return whether they may fit
  template <class R>
  bool start(Cuda& cuda, const ApgdPasses<R, float>& a) {
    constexpr ContactLayout kLayout = layout_of<R>();
    const bool has_tangential = !a.metric.values.empty() && !a.metric.one_each;
    own_ = {has_tangential, !a.p.friction.values.empty(), !a.p.adhesion.values.empty(),
            !a.p.drift.empty()};
    is_streamed_ = kLayout == ContactLayout::general;
    keeps_lists_ = !a.has_moving_bias;
    kernel_ = resident_program(kLayout, law_of<R>(a.exact), own_.has_any(kLayout));
    int processors = 0, bytes = 0;
    const auto ask = [&](int& value, cudaDeviceAttr what) {
      check_cuda(cudaDeviceGetAttribute(&value, what, cuda.device()), "device of apgd_resident");
    };
    ask(processors, cudaDevAttrMultiProcessorCount);
    ask(bytes, cudaDevAttrMaxSharedMemoryPerBlockOptin);
    cudaFuncAttributes attributes;
    check_cuda(cudaFuncGetAttributes(&attributes, kernel_), "attributes of apgd_resident");
    most_bytes_ = static_cast<unsigned>(bytes) - static_cast<unsigned>(attributes.sharedSizeBytes);
    const Index owned = a.p.bodies.owned_count;
    blocks_ = static_cast<unsigned>(
        std::clamp(owned / kLeastResident, 1, std::min(processors, kLeastThreads)));
    // The largest tile has its share at least.
    TileCount share;
    share.bodies = static_cast<unsigned>(owned) / blocks_;
    share.contacts[0] = static_cast<unsigned>(a.p.contact_count) / blocks_;
    if (!fits(share)) return false;

    // Counters, then the largest counts: all start at zero.
    constexpr Offset kWords = kCounters + sizeof(TileCount) / sizeof(unsigned);
    counters_.reserve_discard(kWords);
    fill(cuda, counters_.view(kWords), 0u);
    told_.reserve_discard(2 * blocks_);
    cut_.reserve_discard(Offset{blocks_} + 1);
    cut_tiles<<<blocks_, kResidentThreads, 0, cuda.stream()>>>(
        a.p.lists(0), kLayout == ContactLayout::mixed ? a.p.lists(1) : ContactLists{}, a.p.body_a,
        a.p.body_b, owned, cut_.data(), most());
    cuda.check_launch("cut_tiles");
    send_note(cuda, static_cast<const TileCount*>(most()));
    return true;
  }

  /// Whether tiles fit, after start() said that they may and sent a note.
  bool fits(Cuda& cuda) {
    if (!fits(read_note<TileCount>(cuda))) return false;
    if (is_streamed_) records_.reserve_discard(tile_records() * blocks_);
    far_numbers_.reserve_discard((Offset{layout_.contacts[0]} + layout_.contacts[1]) * blocks_);
    if (keeps_lists_)
      image_.reserve_discard(static_cast<Offset>(layout_.image_bytes / sizeof(float4)) * blocks_);
    return true;
  }

  void run(Cuda& cuda, RadialPasses<float> passes, int count, double enough) {
    unsigned* counter = counters_.data();
    ResidentShared shared{{counter, told_.data()},
                          counter + 1,
                          counter + 2,
                          counter + 3,
                          std::as_const(cut_).data(),
                          records_.data(),
                          static_cast<Index>(tile_records()),
                          far_numbers_.data(),
                          keeps_lists_ ? image_.data() : nullptr};
    void* arguments[] = {&passes, &layout_, &shared, &count, &enough};
    check_cuda(cudaFuncSetAttribute(kernel_, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                    static_cast<int>(layout_.bytes)),
               "shared memory of apgd_resident");
    check_cuda(cudaLaunchCooperativeKernel(kernel_, blocks_, threads(), arguments, layout_.bytes,
                                           cuda.stream()),
               "apgd_resident");
    cuda.check_launch("apgd_resident");
  }

 private:
  static constexpr Offset kCounters = 4;
  TileCount* most() { return reinterpret_cast<TileCount*>(counters_.data() + kCounters); }

  /// Bodies of a tile at least: smaller ones cost more in meetings than they save.
  static constexpr Index kLeastResident = 32;
  /// Of a block: BlockBoard::read() takes one for each block.
  static constexpr Index kLeastThreads = 512;

  /// Of a block: one for each body, but enough for contacts to hide what they wait for. More wait for each other.
  unsigned threads() const {
    return static_cast<unsigned>(
        std::clamp((layout_.bodies + 31) / 32 * 32, kLeastThreads, kResidentThreads));
  }

  Offset tile_records() const { return StreamedContacts::records(own_, layout_.contacts[0]); }

  bool fits(const TileCount& n) {
    const auto bodies = static_cast<std::size_t>(n.bodies), halo = static_cast<std::size_t>(n.halo);
    if (bodies + halo > kMostInTile || n.halo > kMostHalo) return false;
    for (const unsigned contacts : n.contacts)
      if (contacts > kMostInTile) return false;
    SharedRoom room;
    layout_.counts = room.take<int>(kGroups + 1);
    layout_.halo_body = room.take<Index>(halo);
    const auto place_all = [&](auto kind) {
      using First = typename decltype(kind)::type;
      First::place(room, bodies, n.contacts[0], n.listed[0], own_, layout_.group[0]);
      GeneralContacts::place(room, bodies, n.contacts[1], n.listed[1], own_, layout_.group[1]);
      layout_.image_bytes = room.take<float4>(0);
      First::place_impulses(room, n.contacts[0], layout_.group[0]);
      GeneralContacts::place_impulses(room, n.contacts[1], layout_.group[1]);
    };
    if (is_streamed_) {
      place_all(std::type_identity<StreamedContacts>{});
    } else {
      place_all(std::type_identity<RadialContacts>{});
    }
    layout_.extrapolated = room.take<Twist<float>>(bodies + halo);
    layout_.halo_velocity = room.take<Twist<float>>(halo);
    // Half of its places are free, and it takes 16 of the 24 bytes that V_y of the halo will.
    layout_.set_size = std::bit_ceil(2 * n.halo + 1);
    layout_.own = own_;
    layout_.bodies = static_cast<Index>(n.bodies);
    for (int k = 0; k < kGroups; ++k) layout_.contacts[k] = static_cast<Index>(n.contacts[k]);
    layout_.bytes = room.bytes;
    return room.bytes <= most_bytes_;
  }

  template <class R>
  static constexpr ContactLayout layout_of() {
    if (std::is_same_v<R, GeneralRows<float>>) return ContactLayout::general;
    return kIsMixed<R, float> ? ContactLayout::mixed : ContactLayout::radial;
  }

  Buffer<Cuda, unsigned> counters_;
  Buffer<Cuda, Sums<3>> told_;
  Buffer<Cuda, float4> records_, image_;
  Buffer<Cuda, Index> cut_, far_numbers_;
  TileLayout layout_;
  OwnValues own_;
  bool is_streamed_ = false;
  bool keeps_lists_ = false;  ///< from one launch to the next
  const void* kernel_ = nullptr;
  unsigned blocks_ = 0, most_bytes_ = 0;
};

}  // namespace apgd_sweep
}  // namespace scree
