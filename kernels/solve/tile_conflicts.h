#pragma once
// Finds the tiles that conflict with each tile.

#include <algorithm>

#include "kernels/backend/backend.h"
#include "kernels/solve/body_tiles.h"

namespace scree {

/// Lists of tiles, one for each element of a pass, each tile once in a list.
struct TileLists {
  Index room = 0;  ///< for one list
  Span<Index> tile;
  Span<Index> count;  ///< found, maybe more than once each where room was short

  SCREE_HD void add(Index list, Index tile_to_add, Index& found) const {
    const Offset first = static_cast<Offset>(list) * room;
    const Index stored = found < room ? found : room;
    for (Index k = 0; k < stored; ++k) {
      if (tile[first + k] == tile_to_add) return;
    }
    if (found < room) tile[first + found] = tile_to_add;
    ++found;
  }
};

/// Tiles in conflict with that of a few bodies, because of these bodies and of their contacts as A.
/// The tiles' lists are put together from these; in one go they would keep few threads busy.
struct ConflictsOfPart {
  static constexpr const char* name = "conflicts_of_part";
  static constexpr Index kBodies = 8;  ///< of a part; tiles are multiples of it
  BodyTiles tiles;
  TileLists to;  ///< [parts]

  /// @return room needed; when there is less, tiles are missing
  SCREE_HD Largest<Index> operator()(Index part) const {
    const Index begin = part * kBodies;
    const Index end = begin + kBodies < tiles.owned_count ? begin + kBodies : tiles.owned_count;
    const Index t = tiles.of_body(begin);
    Index found = 0;
    for (Index i = begin; i < end; ++i) add_others(part, t, i, found);
    for (Index c = tiles.a_start[begin]; c < tiles.a_start[end]; ++c) {
      const Index b = tiles.body_b[c];
      if (b >= tiles.owned_count || tiles.of_body(b) == t) continue;
      to.add(part, tiles.of_body(b), found);
      add_others(part, t, b, found);
    }
    to.count[part] = found;
    return {found};
  }

 private:
  /// Tiles with contacts that have body i as B.
  SCREE_HD void add_others(Index part, Index t, Index i, Index& found) const {
    for (Index e = tiles.b_start[i]; e < tiles.b_start[i + 1]; ++e) {
      const Index other = tiles.of_contact(tiles.b_contact[e]);
      if (other != t) to.add(part, other, found);
    }
  }
};

/// Tiles in conflict with a tile, put together from those of its parts.
struct ConflictsOfTile {
  static constexpr const char* name = "conflicts_of_tile";
  static constexpr Index kChunk = 16;
  BodyTiles tiles;
  TileLists from;  ///< [parts]
  TileLists to;    ///< [tiles]
  SCREE_HD Largest<Index> operator()(Index t) const {
    constexpr Index kBodies = ConflictsOfPart::kBodies;
    Index found = 0;
    for (Index part = tiles.begin(t) / kBodies; part * kBodies < tiles.end(t); ++part) {
      const Offset first = static_cast<Offset>(part) * from.room;
      for (Index k = 0; k < from.count[part]; ++k) to.add(t, from.tile[first + k], found);
    }
    to.count[t] = found;
    return {found};
  }
};

/// Memory of lists, which grows until they fit.
template <class B>
class TileListsBuffer {
 public:
  explicit TileListsBuffer(B& b) : tile_(b), count_(b), largest_(b, 1) {}

  TileLists view() { return {room_, tile_.view(), count_.view()}; }

  /// @param n     number of lists
  /// @param room  tried first
  /// @param make  (TileLists, Largest* needed): fills the lists and stores the room they need
  template <class Make>
  void fill(B& b, Index n, Index room, Make make) {
    room_ = std::max(room_, room);
    count_.reserve_discard(n);
    for (;;) {
      tile_.reserve_discard(static_cast<Offset>(room_) * n);
      make(view(), largest_.data());
      const Index needed = fetch(b, largest_.data()).value;
      if (needed <= room_) return;
      room_ = std::min(needed, 2 * room_);  // what did not fit may have been counted often
    }
  }

 private:
  Index room_ = 0;
  Buffer<B, Index> tile_;
  Buffer<B, Index> count_;
  Buffer<B, Largest<Index>> largest_;
};

/// Finds the conflicts of all tiles by element programs.
template <class B>
class PlainConflicts {
 public:
  explicit PlainConflicts(B& b) : of_part_(b), of_tile_(b) {}

  /// @param tiles  of a multiple of ConflictsOfPart::kBodies bodies
  void find(B& b, const BodyTiles& tiles) {
    const Index parts =
        (tiles.owned_count + ConflictsOfPart::kBodies - 1) / ConflictsOfPart::kBodies;
    of_part_.fill(b, parts, 16, [&](const TileLists& to, Largest<Index>* needed) {
      reduce<Largest<Index>>(b, parts, ConflictsOfPart{tiles, to},
                             StoreResult<Largest<Index>>{needed});
    });
    of_tile_.fill(b, tiles.count(), 48, [&](const TileLists& to, Largest<Index>* needed) {
      reduce<Largest<Index>>(b, tiles.count(), ConflictsOfTile{tiles, of_part_.view(), to},
                             StoreResult<Largest<Index>>{needed});
    });
  }
  /// Conflicts of each tile, in any order.
  TileLists lists() { return of_tile_.view(); }

 private:
  TileListsBuffer<B> of_part_;
  TileListsBuffer<B> of_tile_;
};

/// The same; backends with a tuned twin specialize it.
template <class B>
class TileConflicts : public PlainConflicts<B> {
 public:
  using PlainConflicts<B>::PlainConflicts;
};

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/solve/tile_conflicts.cuh"
#endif
