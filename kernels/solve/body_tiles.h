#pragma once
// Tiles of a contact problem: runs of bodies that are neighbors in storage, hence in space, each
// with the contacts that have their body A in it.
//
// Two tiles conflict when their contacts share an owned body. Tiles of one color do not conflict,
// and within a tile contacts of one color do not either; both colorings are greedy in a fixed order,
// so they are the same on every backend. Here free bodies are owned ones; ghosts, which a solver does
// not move, are among the fixed.

#include "kernels/contact/contact_problem.h"

namespace scree {

/// The tiles of a problem, and who touches a body: its own tile, always, and those
/// of its contacts as B.
struct BodyTiles {
  Index bodies = 1;  ///< of a tile
  Index owned_count = 0;
  Span<const Index> body_a;
  Span<const Index> body_b;
  Span<const Index> a_start;
  Span<const Index> b_start;
  Span<const Index> b_contact;

  SCREE_HD Index count() const { return (owned_count + bodies - 1) / bodies; }
  SCREE_HD Index of_body(Index i) const { return i / bodies; }
  SCREE_HD Index of_contact(Index c) const { return of_body(body_a[c]); }
  SCREE_HD Index begin(Index tile) const { return tile * bodies; }
  SCREE_HD Index end(Index tile) const {
    const Index last = begin(tile) + bodies;
    return last < owned_count ? last : owned_count;
  }
  /// Contacts of a tile: [first_contact(tile), first_contact(tile + 1)).
  SCREE_HD Index first_contact(Index tile) const { return a_start[end(tile - 1)]; }
};

}  // namespace scree
