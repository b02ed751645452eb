#pragma once
// A tile of bodies with all of their contacts in the shared memory of a block, where they stay through many trials:
// which contacts a tile has. See apgd_resident.cuh.
//
// A contact whose bodies lie in two tiles is in both of them, and both step it, to the same bits. So what a body needs
// is in its tile, but for V of the bodies outside, which come through global memory once a trial.

#include <bit>
#include <cstdint>

#include "kernels/backend/wide_records.cuh"
#include "kernels/solve/apgd_tile.cuh"

namespace scree {
namespace apgd_sweep {

inline constexpr int kResidentThreads = 768;  ///< of a block, one a multiprocessor, at most
inline constexpr int kResidentWarps = kResidentThreads / 32;

/// Threads of this block.
__device__ inline Index block_threads() { return static_cast<Index>(blockDim.x); }

/// The contacts of all layouts but the mixed one are the first group, which has two.
inline constexpr int kGroups = 2;

/// What a tile has, or the most that any has.
struct TileCount {
  unsigned bodies = 0;
  unsigned contacts[kGroups] = {};  ///< with a body in the tile
  unsigned listed[kGroups] = {};    ///< with body B there
  unsigned halo = 0;                ///< bodies outside that have contacts with one inside
};

/// Numbers in a tile have 16 bits, the upper one of which is spare while it is loaded.
inline constexpr unsigned kMostInTile = 32767;
/// Bodies of a halo that are counted: a larger one, which no device has room for yet, is not told to its end.
inline constexpr unsigned kMostHalo = 4096;

/// The bodies of a contact by their numbers in the tile, in a word.
struct Ends {
  unsigned word;
  /// @param inside  body A, or B where A is outside
  /// @param other   the other body; behind those of the tile are those of its halo
  __device__ Ends(unsigned inside, unsigned other) : word(inside | other << 16) {}
  explicit __device__ Ends(float w) : word(std::bit_cast<unsigned>(w)) {}
  __device__ float as_float() const { return std::bit_cast<float>(word); }
  __device__ unsigned inside() const { return word & 0xffffu; }
  __device__ unsigned other() const { return word >> 16; }
};

/// Hands out shared memory: byte offsets of arrays, one after the other.
struct SharedRoom {
  unsigned bytes = 0;
  template <class T>
  unsigned take(std::size_t count) {
    const auto begin = static_cast<unsigned>((bytes + alignof(T) - 1) / alignof(T) * alignof(T));
    bytes = begin + static_cast<unsigned>(sizeof(T) * count);
    return begin;
  }
};

/// Where the arrays of TileLists lie [bytes].
struct ListsLayout {
  unsigned b_contact = 0, a_begin = 0, b_begin = 0;
  ListsLayout() = default;
  ListsLayout(SharedRoom& room, std::size_t bodies, std::size_t listed)
      : b_contact(room.take<std::uint16_t>(listed)),
        a_begin(room.take<std::uint16_t>(bodies + 1)),
        b_begin(room.take<std::uint16_t>(bodies + 1)) {}
};

/// Bodies [begin, begin + count) of the problem.
struct TileOfBodies {
  Index begin, count;
  /// @param cut  of cut_tiles()
  __device__ TileOfBodies(const Index* cut, unsigned tile)
      : begin(cut[tile]), count(cut[tile + 1] - begin) {}
  __device__ bool has(Index i) const {
    return static_cast<unsigned>(i - begin) < static_cast<unsigned>(count);
  }
};

/// Sets a pointer to an array in shared memory.
template <class T>
__device__ void point(T*& to, unsigned char* bytes, unsigned offset) {
  to = reinterpret_cast<T*>(bytes + offset);
}

/// The contacts of one group that a tile has, by numbers: first those whose body A is inside, which follow each other,
/// sorted by A; then the far ones, of which only B is, sorted by B.
struct TileLists {
  std::uint16_t* a_begin;  ///< body i is A of [a_begin[i], a_begin[i + 1])
  std::uint16_t* b_begin;  ///< and B of those listed there
  std::uint16_t* b_contact;
  Index first = 0;  ///< number of the first own one in its group
  Index own = 0, all = 0;

  __device__ TileLists(unsigned char* bytes, const ListsLayout& at) {
    point(a_begin, bytes, at.a_begin);
    point(b_begin, bytes, at.b_begin);
    point(b_contact, bytes, at.b_contact);
  }
  __device__ void take_range(const ContactLists& lists, const TileOfBodies& tile) {
    first = lists.a_start[tile.begin];
    own = lists.a_start[tile.begin + tile.count] - first;
  }
  /// Contacts of body i.
  __device__ int count(Index i) const {
    return a_begin[i + 1] - a_begin[i] + b_begin[i + 1] - b_begin[i];
  }
};

/// Exclusive prefix sum over the block, which comes here as a whole.
/// @param total  of all threads, out
__device__ inline unsigned scan_block(unsigned mine, unsigned& total) {
  __shared__ unsigned of_warp[kResidentWarps];
  const auto lane = static_cast<int>(threadIdx.x % 32);
  unsigned sum = mine;
#pragma unroll
  for (int step = 1; step < 32; step *= 2) {
    const unsigned below = __shfl_up_sync(0xffffffffu, sum, step);
    if (lane >= step) sum += below;
  }
  __syncthreads();
  if (lane == 31) of_warp[threadIdx.x / 32] = sum;
  __syncthreads();
  unsigned before = 0;
  total = 0;
  for (unsigned k = 0; k < blockDim.x / 32; ++k) {
    if (k < threadIdx.x / 32) before += of_warp[k];
    total += of_warp[k];
  }
  return before + sum - mine;
}

/// Calls body(k, is_there) for k = threadIdx.x, + blockDim.x, ..., as long as any thread of the block has one below
/// `count`.
template <class Body>
__device__ void for_all_threads(Index count, const Body& body) {
  for (Index base = 0; base < count; base += block_threads()) {
    const Index k = base + static_cast<Index>(threadIdx.x);
    body(k, k < count);
  }
}

/// A set of bodies in shared memory. Which place a body gets depends on which thread comes first, and so do the numbers
/// in a halo; no sum depends on them.
struct BodySet {
  static constexpr Index kFree = -1;
  Index* place;
  unsigned size;  ///< a power of two, above the number of bodies

  /// By all threads of the block; it has to synchronize before and after.
  __device__ void clear() const {
    for (unsigned k = threadIdx.x; k < size; k += blockDim.x) place[k] = kFree;
  }
  /// @param is_new  out: it was not there
  /// @return        place of the body
  __device__ unsigned add(Index body, bool& is_new) const {
    unsigned k = static_cast<unsigned>(body) * 2654435761u & (size - 1);
    for (;; k = (k + 1) & (size - 1)) {
      const Index there = atomicCAS(&place[k], kFree, body);
      is_new = there == kFree;
      if (is_new || there == body) return k;
    }
  }
};

/// Where tile `tile` of several begins, so that they take about the same time: the slowest one is what all wait for. By a
/// warp.
__device__ inline Index cut_of_tile(const ContactLists& first_group,
                                    const ContactLists& second_group, Index owned, unsigned tile,
                                    unsigned tiles) {
  constexpr Index kBodyCost = 6;  // of a body, over that of being in a contact
  const auto lane = static_cast<Index>(threadIdx.x % 32);
  const auto cost_before = [&](Index i) {
    Offset cost = Offset{kBodyCost} * i + first_group.a_start[i] + first_group.b_start[i];
    if (!second_group.a_start.empty()) cost += second_group.a_start[i] + second_group.b_start[i];
    return cost;
  };
  const Offset wanted = cost_before(owned) * tile / tiles;
  // The first body where the cost before it is not below the wanted one.
  Index low = 0, high = owned;
  while (low < high) {
    const Index step = (high - low + 31) / 32;
    const Index mine = min(low + lane * step, high);
    const unsigned reached = __ballot_sync(0xffffffffu, cost_before(mine) >= wanted);
    const Index first = reached == 0 ? 32 : __ffs(static_cast<int>(reached)) - 1;
    const Index begin = low;
    if (first < 32) high = min(begin + first * step, high);
    if (first > 0) low = min(begin + (first - 1) * step + 1, high);
  }
  return low;
}

/// Cuts the bodies into tiles and counts what each has, a block for each.
/// @param cut   [tiles + 1] out: the first bodies of tiles
/// @param most  in: zero; out: the largest counts
static __global__ void __launch_bounds__(kResidentThreads, 1)
    cut_tiles(const __grid_constant__ ContactLists first_group,
              const __grid_constant__ ContactLists second_group, Span<const Index> body_a,
              Span<const Index> body_b, Index owned, Index* cut, TileCount* most) {
  constexpr unsigned kPlaces = 2 * kMostHalo;
  __shared__ Index place[kPlaces];
  __shared__ unsigned halo;
  const BodySet outside{place, kPlaces};
  __shared__ Index ends[2];
  outside.clear();
  if (threadIdx.x == 0) halo = 0;
  if (const unsigned side = threadIdx.x / 32; side < 2) {
    const unsigned number = blockIdx.x + side;
    const Index at = cut_of_tile(first_group, second_group, owned, number, gridDim.x);
    ends[side] = at;
    if (side == 0 || number == gridDim.x) cut[number] = at;
  }
  __syncthreads();
  const TileOfBodies tile(ends, 0);
  const auto add = [&](Index body) {
    // A halo that is too large stays so, and the set never gets full: each thread adds one more at most.
    if (*static_cast<volatile unsigned*>(&halo) > kMostHalo) return;
    bool is_new;
    outside.add(body, is_new);
    if (is_new) atomicAdd(&halo, 1u);
  };
  for (int k = 0; k < kGroups; ++k) {
    const ContactLists& lists = k == 0 ? first_group : second_group;
    if (lists.a_start.empty()) continue;
    const Index first = lists.a_start[tile.begin], last = lists.a_start[tile.begin + tile.count];
    const Index begin = lists.b_start[tile.begin], end = lists.b_start[tile.begin + tile.count];
    unsigned far = 0, all_far;
    for (Index at = begin + static_cast<Index>(threadIdx.x); at < end; at += block_threads()) {
      const Index c = lists.b_contact[at];
      if (c >= first && c < last) continue;
      ++far;
      add(body_a[lists.first + c]);
    }
    for (Index c = first + static_cast<Index>(threadIdx.x); c < last; c += block_threads()) {
      const Index b = body_b[lists.first + c];
      if (!tile.has(b)) add(b);
    }
    scan_block(far, all_far);
    if (threadIdx.x > 0) continue;
    atomicMax(&most->contacts[k], static_cast<unsigned>(last - first) + all_far);
    atomicMax(&most->listed[k], static_cast<unsigned>(end - begin));
  }
  __syncthreads();
  if (threadIdx.x > 0) return;
  atomicMax(&most->bodies, static_cast<unsigned>(tile.count));
  atomicMax(&most->halo, halo);
}

/// Upper bit of Ends::other() of a body outside, while its number is its place in a BodySet.
inline constexpr unsigned kPlaced = 0x8000;

/// Lists the contacts of a tile, all threads together. Bodies outside are put into a set; name_outside() is to follow.
/// @tparam Contacts  RadialContacts, GeneralContacts or StreamedContacts
/// @param lists      of the group, in the problem
/// @param far_number [far contacts] out: their numbers in the group
template <class Contacts>
__device__ void list_contacts(const ContactProblem<float>& p, const ContactLists& lists,
                              const TileOfBodies& tile, const BodySet& outside, Index* far_number,
                              Contacts& to) {
  const Index first = to.first;
  const Index* b_start = lists.b_start.data + tile.begin;
  const auto is_far = [&](Index c) { return c < first || c >= first + to.own; };
  unsigned fars = 0;  // of the bodies before
  for_all_threads(tile.count, [&](Index i, bool is_there) {
    unsigned mine = 0, total;
    if (is_there) {
      for (Index at = b_start[i]; at < b_start[i + 1]; ++at)
        mine += is_far(lists.b_contact[at]) ? 1 : 0;
    }
    auto far = static_cast<Index>(fars + scan_block(mine, total));
    fars += total;
    if (!is_there) return;
    to.a_begin[i] = static_cast<std::uint16_t>(lists.a_start[tile.begin + i] - first);
    to.b_begin[i] = static_cast<std::uint16_t>(b_start[i] - b_start[0]);
    for (Index at = b_start[i]; at < b_start[i + 1]; ++at) {
      const Index c = lists.b_contact[at];
      Index k = c - first;
      if (is_far(c)) {
        k = to.own + far;
        to.set_ends(k, Ends(static_cast<unsigned>(i), 0));
        far_number[far++] = c;
      }
      to.b_contact[at - b_start[0]] = static_cast<std::uint16_t>(k);
    }
  });
  to.all = to.own + static_cast<Index>(fars);
  if (threadIdx.x == 0) {
    to.a_begin[tile.count] = static_cast<std::uint16_t>(to.own);
    to.b_begin[tile.count] = static_cast<std::uint16_t>(b_start[tile.count] - b_start[0]);
  }
  __syncthreads();
  for (auto k = static_cast<Index>(threadIdx.x); k < to.all; k += block_threads()) {
    const bool is_own = k < to.own;
    const Index c = lists.first + (is_own ? first + k : far_number[k - to.own]);
    const Index other = is_own ? p.body_b[c] : p.body_a[c];
    const unsigned inside =
        is_own ? static_cast<unsigned>(p.body_a[c] - tile.begin) : to.ends(k).inside();
    bool is_new;
    to.set_ends(k,
                Ends(inside, is_own && tile.has(other) ? static_cast<unsigned>(other - tile.begin)
                                                       : kPlaced | outside.add(other, is_new)));
  }
}

/// Brings the data of contacts that are listed.
/// @param is_first  also what stays through a solve
template <class Contacts>
__device__ void load_contacts(const RadialPasses<float>& a, const ContactLists& lists,
                              const Index* far_number, bool is_first, const Contacts& to) {
  for (auto k = static_cast<Index>(threadIdx.x); k < to.all; k += block_threads()) {
    const Index number = k < to.own ? to.first + k : far_number[k - to.own];
    const Index c = lists.first + number;
    if (is_first) to.load(a, k, c, number);
    to.load_impulses(a, k, c);
  }
}

/// Numbers the bodies of a set, and puts these numbers where their places were.
/// @param body  [bodies] out
/// @return      how many there are
__device__ inline Index number_bodies(const BodySet& set, Index* body) {
  unsigned before = 0;
  __syncthreads();
  for_all_threads(static_cast<Index>(set.size), [&](Index k, bool is_there) {
    unsigned total;
    const Index mine = is_there ? set.place[k] : BodySet::kFree;
    const unsigned number = before + scan_block(mine != BodySet::kFree ? 1 : 0, total);
    before += total;
    if (mine == BodySet::kFree) return;
    body[number] = mine;
    set.place[k] = static_cast<Index>(number);
  });
  __syncthreads();
  return static_cast<Index>(before);
}

/// Gives bodies outside the numbers that they got in number_bodies(), behind those inside.
template <class Contacts>
__device__ void name_outside(const BodySet& set, Index tile_bodies, const Contacts& to) {
  for (auto k = static_cast<Index>(threadIdx.x); k < to.all; k += block_threads()) {
    const Ends ends = to.ends(k);
    if (ends.other() < kPlaced) continue;
    const Index number = tile_bodies + set.place[ends.other() - kPlaced];
    to.set_ends(k, Ends(ends.inside(), static_cast<unsigned>(number)));
  }
}

/// Writes the impulses of own contacts back.
template <class Contacts>
__device__ void store_impulses(const ApgdImpulses<float>& to, Index first_of_group,
                               const Contacts& from) {
  for (auto k = static_cast<Index>(threadIdx.x); k < from.own; k += block_threads()) {
#pragma unroll
    for (int j = 0; j < 2; ++j) to.buffer[j][first_of_group + from.first + k] = from.impulse(j, k);
  }
}

}  // namespace apgd_sweep
}  // namespace scree
