#pragma once
// Tuned twin of the programs that find conflicts: a warp collects those of a tile in a hash table
// in shared memory. By one thread for each eight bodies, lists in device memory are searched: 0.8
// ms for 1e6 bodies.

#include "kernels/backend/cuda.cuh"
#include "kernels/solve/tile_conflicts.h"

namespace scree {
namespace conflicts {

inline constexpr int kLanes = 32;   ///< threads of a block
inline constexpr int kSlots = 128;  ///< of the hash table
/// Conflicts that it is made for; more are counted as kSlots.
inline constexpr Index kMaxConflicts = 100;

/// Puts a tile into the table, unless it is there.
/// @return whether it is there now
__device__ inline bool insert(Index* table, Index tile) {
  unsigned slot = static_cast<unsigned>(tile) * 0x9e3779b1U >> 25;
  for (int k = 0; k < kSlots; ++k, slot = (slot + 1) % kSlots) {
    const Index found = atomicCAS(&table[slot], -1, tile);
    if (found == -1 || found == tile) return true;
  }
  return false;
}

/// Lists conflicts in ascending order, and stores the largest number.
template <class Tiles>
__global__ void __launch_bounds__(kLanes)
    find_conflicts(const __grid_constant__ Tiles tiles, const TileLists to,
                   Largest<Index>* needed) {
  __shared__ Index table[kSlots];
  const auto lane = static_cast<Index>(threadIdx.x);
  const auto t = static_cast<Index>(blockIdx.x);
  for (int k = lane; k < kSlots; k += kLanes) table[k] = -1;
  __syncwarp();
  bool fits = true;
  const auto add = [&](Index tile) {
    if (tile != t && fits) fits = insert(table, tile);
  };
  for (Index e = tiles.b_start[tiles.begin(t)] + lane; e < tiles.b_start[tiles.end(t)]; e += kLanes)
    add(tiles.of_contact(tiles.b_contact[e]));
  for (Index c = tiles.first_contact(t) + lane; c < tiles.first_contact(t + 1); c += kLanes) {
    const Index b = tiles.body_b[c];
    if (b >= tiles.owned_count || tiles.of_body(b) == t) continue;
    add(tiles.of_body(b));
    for (Index e = tiles.b_start[b]; e < tiles.b_start[b + 1]; ++e)
      add(tiles.of_contact(tiles.b_contact[e]));
  }
  __syncwarp();
  Index count = 0;
  for (int k = 0; k < kSlots; k += kLanes)
    count += __popc(__ballot_sync(0xffffffffu, table[k + lane] >= 0));
  if (__any_sync(0xffffffffu, !fits) || count > kMaxConflicts) count = kSlots;
  for (int k = lane; k < kSlots; k += kLanes) {
    const Index tile = table[k];
    if (tile < 0) continue;
    Index rank = 0;
    for (int j = 0; j < kSlots; ++j) rank += table[j] >= 0 && table[j] < tile ? 1 : 0;
    if (rank < to.room) to.tile[static_cast<Offset>(t) * to.room + rank] = tile;
  }
  if (lane == 0) {
    to.count[t] = count;
    atomicMax(&needed->value, count);
  }
}

}  // namespace conflicts

template <>
class TileConflicts<Cuda> {
 public:
  explicit TileConflicts(Cuda& cuda) : plain_(cuda), of_tile_(cuda) {}

  void find(Cuda& cuda, const BodyTiles& tiles) {
    of_tile_.fill(cuda, tiles.count(), 48, [&](const TileLists& to, Largest<Index>* needed) {
      fill(cuda, Span<Largest<Index>>{needed, 1}, Largest<Index>{});
      conflicts::find_conflicts<<<static_cast<unsigned>(tiles.count()), conflicts::kLanes, 0,
                                  cuda.stream()>>>(tiles, to, needed);
      cuda.check_launch("find_conflicts");
    });
    // A body that touches very many tiles.
    is_plain_ = of_tile_.view().room >= conflicts::kSlots;
    if (is_plain_) plain_.find(cuda, tiles);
  }
  TileLists lists() { return is_plain_ ? plain_.lists() : of_tile_.view(); }

 private:
  PlainConflicts<Cuda> plain_;
  TileListsBuffer<Cuda> of_tile_;
  bool is_plain_ = false;
};

}  // namespace scree
