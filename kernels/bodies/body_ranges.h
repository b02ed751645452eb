#pragma once
// Whose a body is, by its place in storage.

#include "kernels/types.h"

namespace scree {

/// Storage of bodies: four ranges, one after the other.
///
///   owned  [0, owned_count)             free bodies that this World integrates, reports and writes
///   ghost  [owned_count, moving_count)  copies of free bodies that another World owns: they have a
///                                       velocity and a mass, and contacts with owned bodies only
///   room   [moving_count, fixed_begin)  storage that is not in use
///   fixed  [fixed_begin, count)         walls, and bodies whose motion is prescribed
///
/// docs/ARCHITECTURE.md, section "Ranges of bodies".
struct BodyRanges {
  Index owned_count = 0;
  Index moving_count = 0;  ///< owned bodies and ghosts
  Index fixed_begin = 0;
  Index count = 0;  ///< size of storage
  /// Ghosts from here on belong to ranks above this one, those before to ranks below.
  Index higher_begin = 0;

  SCREE_HD bool is_owned(Index i) const { return i < owned_count; }
  /// Owned bodies and ghosts.
  SCREE_HD bool moves(Index i) const { return i < moving_count; }
  SCREE_HD bool is_fixed(Index i) const { return i >= fixed_begin; }
  SCREE_HD bool is_ghost(Index i) const { return moves(i) && !is_owned(i); }
  /// Whether there may be contacts that do not count here: see counts().
  SCREE_HD bool has_uncounted() const { return higher_begin > owned_count; }
  /// Whether a contact with body B counts here: one with a ghost is listed by both owners, and counts where the rank is
  /// lower.
  SCREE_HD bool counts(Index b) const { return is_owned(b) || !moves(b) || b >= higher_begin; }
  /// The same of contacts and joints, of which either body may be the ghost.
  SCREE_HD bool counts(Index a, Index b) const { return counts(a) && counts(b); }
  /// Whether a place of storage is in use.
  SCREE_HD bool exists(Index i) const { return moves(i) || (is_fixed(i) && i < count); }

  SCREE_HD Index fixed_count() const { return count - fixed_begin; }
  /// Bodies that there are, without room between them.
  SCREE_HD Index present_count() const { return moving_count + fixed_count(); }
  /// Storage index of the m-th of them.
  SCREE_HD Index present(Index m) const {
    return m < moving_count ? m : m - moving_count + fixed_begin;
  }

  /// What a World reports and draws: ghosts are for their owners to tell of.
  SCREE_HD BodyRanges without_ghosts() const {
    return {owned_count, owned_count, fixed_begin, count};
  }
  const BodyRanges& ranges() const { return *this; }
  bool operator==(const BodyRanges&) const = default;
};

}  // namespace scree
