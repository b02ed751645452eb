#pragma once
// Numbers the bodies that a tile touches, and colors and orders its contacts.

#include "kernels/backend/backend.h"
#include "kernels/solve/body_tiles.h"
#include "kernels/solve/coloring.h"

namespace scree {

/// Where a contact and its bodies stand within a tile.
struct TileLink {
  std::uint16_t a = 0;      ///< body A, counted from the tile's first
  std::uint16_t b = 0;      ///< body B: own ones, then free ones of other tiles, then fixed ones
  std::uint16_t place = 0;  ///< of the contact in the order (color, contact)
  std::uint16_t color = 0;
};

inline constexpr Index kTileColors = 32;  ///< most colors of contacts within a tile

/// What a sweep over a tile needs to know of it.
struct TileShape {
  Index free_bodies = 0;  ///< its own and those of other tiles
  Index bodies = 0;       ///< with fixed ones, one for each contact with such
  Index colors = 0;       ///< of contacts; 0: none, or too many, then the tile has no links
  std::uint16_t color_end[kTileColors] = {};  ///< places where colors end
};

/// previous[c] = the contact before c in its tile that has the same B, free and of another tile,
/// counted from the tile's first one; or -1.
struct TilePrevious {
  static constexpr const char* name = "tile_previous";
  BodyTiles tiles;
  Span<Index> previous;
  SCREE_HD void operator()(Index c) const {
    previous[c] = -1;
    const Index b = tiles.body_b[c];
    if (b >= tiles.owned_count || tiles.of_body(b) == tiles.of_contact(c)) return;
    const Index first = tiles.first_contact(tiles.of_contact(c));
    Index before = -1;
    for (Index e = tiles.b_start[b]; tiles.b_contact[e] < c; ++e) before = tiles.b_contact[e];
    if (before >= first) previous[c] = before - first;
  }
};

/// Numbers the bodies of a tile and colors its contacts, each with the smallest color that no
/// earlier one on its bodies has. All arrays begin with the tile's first contact or body.
struct TileLinker {
  static constexpr Index kMaxNumber = 0xffff;  ///< contacts, and bodies

  Index begin;  ///< first body
  Index own;    ///< bodies
  Index owned_count;
  Span<const Index> body_a;  ///< [contacts]
  Span<const Index> body_b;
  Span<const Index> previous;
  /// [contacts] out: from the first on free bodies of other tiles, from the last down fixed bodies.
  Span<Index> outside;
  Span<std::uint32_t> inside_colors;   ///< [own] scratch: colors used on own bodies
  Span<std::uint32_t> outside_colors;  ///< [contacts] scratch: on those of other tiles
  Span<TileLink> link;                 ///< [contacts] out

  SCREE_HD void operator()(TileShape& s) const {
    const auto contacts = static_cast<Index>(body_a.size);
    s = {};
    Index free_outside = 0, fixed = 0;
    bool has_links = own + contacts <= kMaxNumber;
    for (Index i = 0; i < own; ++i) inside_colors[i] = 0;
    for (Index c = 0; c < contacts; ++c) {
      const Index a = body_a[c] - begin, b = body_b[c] - begin;
      Index number = b, slot = -1;
      if (body_b[c] >= owned_count) {
        number = fixed;  // they come behind the free ones
        outside[contacts - 1 - fixed++] = body_b[c];
      } else if (b >= own && previous[c] < 0) {
        number = own + free_outside;
        slot = free_outside;
        outside_colors[slot] = 0;
        outside[free_outside++] = body_b[c];
      } else if (b >= own && has_links) {
        number = link[previous[c]].b;
        slot = number - own;
      }
      if (!has_links) continue;  // the others are only counted and listed
      std::uint32_t used = inside_colors[a];
      if (slot >= 0) {
        used |= outside_colors[slot];
      } else if (b < own) {
        used |= inside_colors[b];
      }
      const int color = lowest_bit(~std::uint64_t{used});
      has_links = color < kTileColors;
      if (!has_links) continue;
      const std::uint32_t bit = std::uint32_t{1} << color;
      inside_colors[a] |= bit;
      if (slot >= 0) {
        outside_colors[slot] |= bit;
      } else if (b < own) {
        inside_colors[b] |= bit;
      }
      ++s.color_end[color];
      if (color >= s.colors) s.colors = color + 1;
      link[c] = {static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(number), 0,
                 static_cast<std::uint16_t>(color)};
    }
    s.free_bodies = own + free_outside;
    s.bodies = s.free_bodies + fixed;
    if (has_links) {
      place_contacts(s);
    } else {
      s.colors = 0;
      for (std::uint16_t& end : s.color_end) end = 0;
    }
  }

 private:
  /// Turns counts of colors into their ends, and gives contacts their places.
  SCREE_HD void place_contacts(TileShape& s) const {
    std::uint16_t sum = 0;
    for (Index k = 0; k < s.colors; ++k) {
      const std::uint16_t count = s.color_end[k];
      s.color_end[k] = sum;
      sum = static_cast<std::uint16_t>(sum + count);
    }
    for (Index c = 0; c < body_a.size; ++c) {
      link[c].place = s.color_end[link[c].color]++;
      if (body_b[c] >= owned_count)
        link[c].b = static_cast<std::uint16_t>(s.free_bodies + link[c].b);
    }
  }
};

/// Links of all tiles, in place.
struct LinkTiles {
  static constexpr const char* name = "link_tiles";
  static constexpr Index kSerialBelow = 16;
  BodyTiles tiles;
  Span<const Index> previous;          ///< [contacts]
  Span<Index> outside;                 ///< [contacts]
  Span<std::uint32_t> inside_colors;   ///< [owned_count]
  Span<std::uint32_t> outside_colors;  ///< [contacts]
  Span<TileLink> link;                 ///< [contacts]
  Span<TileShape> shape;               ///< [tiles]
  SCREE_HD void operator()(Index t) const {
    const Index begin = tiles.begin(t), own = tiles.end(t) - begin;
    const Index first = tiles.first_contact(t);
    const Offset n = tiles.first_contact(t + 1) - first;
    TileLinker{begin,
               own,
               tiles.owned_count,
               {tiles.body_a.data + first, n},
               {tiles.body_b.data + first, n},
               {previous.data + first, n},
               {outside.data + first, n},
               {inside_colors.data + begin, own},
               {outside_colors.data + first, n},
               {link.data + first, n}}(shape[t]);
  }
};

/// order[k] = contact at position k of the order (tile, color, contact); of a tile without colors
/// in that of contacts.
struct TileOrder {
  static constexpr const char* name = "tile_order";
  BodyTiles tiles;
  Span<const TileLink> link;
  Span<const TileShape> shape;
  Span<Index> order;
  SCREE_HD void operator()(Index c) const {
    const Index t = tiles.of_contact(c);
    order[shape[t].colors > 0 ? tiles.first_contact(t) + link[c].place : c] = c;
  }
};

/// Links the contacts of all tiles; backends with a tuned twin have their own.
template <class B>
void link_tiles(B& b, const LinkTiles& program) {
  for_each(b, program.tiles.count(), program);
}

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/solve/link_tiles.cuh"
#endif
