#pragma once
// All bodies near each body: the list of near pairs from both sides, so that a body finds what it may meet by itself.

#include "kernels/backend/atomic.h"
#include "kernels/backend/backend.h"
#include "kernels/broad_phase/pair_candidates.h"

namespace scree {

/// Neighbors of each owned body, ascending. Fixed spheres are among them, and have none.
struct NearBodies {
  Span<const Offset> begin;  ///< [owned + 1]
  Span<const Index> other;
};

/// Counts the neighbors of each body. Bytes per pair: 4 read, 8 added to.
struct CountNear {
  static constexpr const char* name = "count_near";
  CandidateView pairs;
  Index owned;
  Span<Index> count;  ///< [owned] in: zero

  SCREE_HD void operator()(Index piece) const {
    const Index a = pairs.body[piece];
    for (Index k = pairs.begin[piece]; k < pairs.begin[piece + 1]; ++k) {
      const Index b = pairs.other[k];
      atomic_add(&count[a], 1);
      if (b < owned) atomic_add(&count[b], 1);
    }
  }
};

/// Puts neighbors into the list of each body, in any order.
struct PlaceNear {
  static constexpr const char* name = "place_near";
  CandidateView pairs;
  Index owned;
  Span<const Offset> begin;
  Span<Index> count;  ///< neighbors still to come
  Span<Index> body;   ///< out: whose list it is
  Span<Index> other;  ///< out

  SCREE_HD void put(Index a, Index b) const {
    const Offset at = begin[a] + atomic_add(&count[a], -1) - 1;
    body[at] = a;
    other[at] = b;
  }
  SCREE_HD void operator()(Index piece) const {
    const Index a = pairs.body[piece];
    for (Index k = pairs.begin[piece]; k < pairs.begin[piece + 1]; ++k) {
      const Index b = pairs.other[k];
      put(a, b);
      if (b < owned) put(b, a);
    }
  }
};

/// The body whose neighbor is at a place.
struct OwnerOf {
  Span<const Index> body;
  SCREE_HD Index operator()(Index k, Index) const { return body[k]; }
};

/// Lists all pairs of few bodies.
struct AllNear {
  static constexpr const char* name = "all_near";
  Index owned;
  Span<const Index> fixed;  ///< fixed spheres
  Span<Offset> begin;       ///< out
  Span<Index> other;        ///< out

  /// @param i  a body, or `owned`
  SCREE_HD void operator()(Index i) const {
    Offset at = static_cast<Offset>(i) * (owned - 1 + fixed.size);
    begin[i] = at;
    if (i == owned) return;
    for (Index k = 0; k < owned; ++k)
      if (k != i) other[at++] = k;
    for (Offset k = 0; k < fixed.size; ++k) other[at++] = fixed[k];
  }
};

}  // namespace scree
