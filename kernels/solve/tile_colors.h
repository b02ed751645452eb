#pragma once
// Element programs that color tiles, and what follows from their order.

#include "kernels/solve/coloring.h"
#include "kernels/solve/tile_conflicts.h"

namespace scree {

/// Tiles without a color, and the number of colors.
struct TileColorsLeft {
  Index uncolored = 0;
  Index colors = 0;
  SCREE_HD void combine(const TileColorsLeft& o) {
    uncolored += o.uncolored;
    if (o.colors > colors) colors = o.colors;
  }
};

/// One round: a tile whose neighbors of higher priority all have colors takes the smallest one that
/// none of them has (Jones & Plassmann, SIAM J. Sci. Comput. 14(3), 1993).
struct TileColorRound {
  static constexpr const char* name = "tile_color_round";
  TileLists neighbors;
  Span<const Index> from;  ///< colors, -1: none yet
  Span<Index> to;

  SCREE_HD void operator()(Index t) const { to[t] = from[t] >= 0 ? from[t] : color(t); }

 private:
  SCREE_HD Index color(Index t) const {
    const Index* const all = neighbors.tile.data + static_cast<Offset>(t) * neighbors.room;
    for (Index first_color = 0;; first_color += kColorsPerBatch) {
      std::uint64_t used = 0;
      for (Index k = 0; k < neighbors.count[t]; ++k) {
        if (!goes_before(all[k], t)) continue;
        if (from[all[k]] < 0) return -1;
        const Index bit = from[all[k]] - first_color;
        if (bit >= 0 && bit < kColorsPerBatch) used |= std::uint64_t{1} << bit;
      }
      if (used != kAllColors) return first_color + lowest_bit(~used);
    }
  }
  /// Tiles with many neighbors first: that takes fewer colors.
  SCREE_HD bool goes_before(Index u, Index t) const {
    if (neighbors.count[u] != neighbors.count[t]) return neighbors.count[u] > neighbors.count[t];
    const std::uint32_t of_u = contact_priority(u), of_t = contact_priority(t);
    return of_u != of_t ? of_u < of_t : u < t;
  }
};

struct CountUncolored {
  static constexpr const char* name = "count_uncolored";
  Span<const Index> color;
  SCREE_HD TileColorsLeft operator()(Index t) const { return {color[t] < 0 ? 1 : 0, color[t] + 1}; }
};

/// first[i] = the tile of lowest color that touches body i.
struct FirstTiles {
  static constexpr const char* name = "first_tiles";
  BodyTiles tiles;
  Span<const Index> color;
  Span<Index> first;
  SCREE_HD void operator()(Index i) const {
    Index best = tiles.of_body(i);
    for (Index e = tiles.b_start[i]; e < tiles.b_start[i + 1]; ++e) {
      const Index t = tiles.of_contact(tiles.b_contact[e]);
      if (color[t] < color[best]) best = t;
    }
    first[i] = best;
  }
};

/// Turns each neighbor u of a tile into 2 u, plus one when it comes after the tile.
struct TellNeighbors {
  static constexpr const char* name = "tell_neighbors";
  TileLists neighbors;
  Span<const Index> color;
  SCREE_HD void operator()(Index t) const {
    const Offset first = static_cast<Offset>(t) * neighbors.room;
    for (Index k = 0; k < neighbors.count[t]; ++k) {
      Index& u = neighbors.tile[first + k];
      u = 2 * u + (color[u] > color[t] ? 1 : 0);
    }
  }
};

}  // namespace scree
