#pragma once
// Cuts a contact problem into tiles, and colors the tiles and the contacts within each.

#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/contact/body_contacts.h"
#include "kernels/solve/tile_colors.h"
#include "kernels/solve/tile_linking.h"

namespace scree {

/// The same contacts give the same tiles, colors and places on every backend.
///
/// Cost: one pass over bodies that looks up the tiles of the contacts around each, two more over
/// bodies and contacts, about 50 rounds over tiles and a sort of them; two host reads and one for
/// each sixteen rounds.
template <class B>
class TileColoring {
 public:
  explicit TileColoring(B& b)
      : conflicts_(b),
        color_{Buffer<B, Index>(b), Buffer<B, Index>(b)},
        key_(b),
        sequence_(b),
        start_(b),
        first_(b),
        outside_(b),
        previous_(b),
        inside_colors_(b),
        outside_colors_(b),
        link_(b),
        shape_(b),
        sort_(b),
        left_(b, 1) {}

  /// @param p            with at least one free body
  /// @param tile_bodies  bodies of a tile, a multiple of ConflictsOfPart::kBodies
  template <class Real>
  void compute(B& b, const ContactProblem<Real>& p, Index tile_bodies) {
    tiles_ = {tile_bodies, p.bodies.owned_count, p.body_a, p.body_b, p.a_start,
              p.b_start,   p.b_contact};
    conflicts_.find(b, tiles_);
    color_tiles(b);
    first_.reserve_discard(p.bodies.owned_count);
    for_each(b, p.bodies.owned_count,
             FirstTiles{tiles_, color(), first_.view(p.bodies.owned_count)});
    link_contacts(b, p.contact_count);
    for_each(b, tiles_.count(), TellNeighbors{conflicts_.lists(), color()});
  }

  const BodyTiles& tiles() const { return tiles_; }
  Index color_count() const { return static_cast<Index>(starts_.size()) - 1; }
  /// Tiles by color [tiles], and where colors start, on the host [color_count + 1].
  Span<const Index> sequence() const { return sequence_.view(tiles_.count()); }
  const std::vector<Index>& starts() const { return starts_; }
  Span<const Index> color() const { return color_[0].view(tiles_.count()); }
  /// Tiles in conflict with each tile, as TellNeighbors leaves them.
  TileLists neighbors() { return conflicts_.lists(); }
  /// The first tile in the sequence that touches a body [owned_count].
  Span<const Index> first() const { return first_.view(tiles_.owned_count); }
  /// See TileLinker [contacts], [contacts], [tiles].
  Span<const TileLink> link() const { return link_.view(tiles_.body_a.size); }
  Span<const Index> outside() const { return outside_.view(tiles_.body_a.size); }
  Span<const TileShape> shape() const { return shape_.view(tiles_.count()); }

 private:
  static constexpr int kRounds = 16;  ///< between host reads

  void color_tiles(B& b) {
    const Index n = tiles_.count();
    for (auto& c : color_) c.reserve_discard(n);
    fill(b, color_[0].view(n), Index(-1));
    TileColorsLeft left;
    do {
      for (int round = 0; round < kRounds; ++round) {
        for_each(b, n, TileColorRound{conflicts_.lists(), color(), color_[1].view(n)});
        swap(color_[0], color_[1]);
      }
      reduce<TileColorsLeft>(b, n, CountUncolored{color()},
                             StoreResult<TileColorsLeft>{left_.data()});
      left = fetch(b, left_.data());
    } while (left.uncolored > 0);

    key_.reserve_discard(n);
    sequence_.reserve_discard(n);
    const Span<std::uint64_t> key = key_.view(n);
    for_each(b, n, ColorKeys{color(), key, sequence_.view(n)});
    sort_pairs(b, sort_, key, sequence_.view(n), bits_for(static_cast<std::uint64_t>(left.colors)));
    start_.reserve_discard(left.colors + 1);
    for_each(b, n + 1, RunStarts<std::uint64_t>{key, n, left.colors, start_.view(left.colors + 1)});
    starts_ = download(b, start_.view(left.colors + 1));
  }

  void link_contacts(B& b, Index contacts) {
    previous_.reserve_discard(contacts);
    outside_.reserve_discard(contacts);
    outside_colors_.reserve_discard(contacts);
    inside_colors_.reserve_discard(tiles_.owned_count);
    link_.reserve_discard(contacts);
    shape_.reserve_discard(tiles_.count());
    for_each(b, contacts, TilePrevious{tiles_, previous_.view(contacts)});
    link_tiles(b, LinkTiles{tiles_, previous_.view(contacts), outside_.view(contacts),
                            inside_colors_.view(tiles_.owned_count), outside_colors_.view(contacts),
                            link_.view(contacts), shape_.view(tiles_.count())});
  }

  BodyTiles tiles_;
  std::vector<Index> starts_{0};
  TileConflicts<B> conflicts_;
  Buffer<B, Index> color_[2];
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> sequence_;
  Buffer<B, Index> start_;
  Buffer<B, Index> first_;
  Buffer<B, Index> outside_;
  Buffer<B, Index> previous_;
  Buffer<B, std::uint32_t> inside_colors_;
  Buffer<B, std::uint32_t> outside_colors_;
  Buffer<B, TileLink> link_;
  Buffer<B, TileShape> shape_;
  SortSpace<B> sort_;
  Buffer<B, TileColorsLeft> left_;
};

}  // namespace scree
