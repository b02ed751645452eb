#pragma once
// The search for near pairs: bodies whose boxes over their ways are near each other, by a sweep along x, and then their features,
// each against the tree of the other body. docs/theory.md, "Barrier contact".

#include <cstring>

#include "kernels/affine/surface_tree.h"
#include "kernels/backend/ordered_lists.h"
#include "kernels/narrow_phase/ignored_pairs.h"

namespace scree::affine {

/// Bits of a number in the order of numbers.
SCREE_HD inline std::uint64_t ordered_bits(double x) {
  std::uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return (bits >> 63) != 0 ? ~bits : bits | (std::uint64_t(1) << 63);
}

/// Boxes of bodies over their ways, and where they begin along x.
struct BoundBodies {
  static constexpr const char* name = "affine_bound_bodies";
  SurfacesView surfaces;
  Span<const AffineVec> from, to;
  Span<const Index> listed;  ///< bodies that are swept: all but large ones
  Span<Bounds> bounds;       ///< out, by body
  Span<std::uint64_t> key;   ///< out, of listed ones
  Span<Index> order;         ///< out, of listed ones

  SCREE_HD void operator()(Index i) const {
    const Index body = listed[i];
    const SurfaceRecord& s = surfaces.surface(body);
    const Bounds b = swept(from[body], to[body], s.center, s.half);
    bounds[body] = b;
    if (i >= key.size) return;
    key[i] = ordered_bits(b.low.x);
    order[i] = body;
  }
};

/// Which bodies may touch.
struct BodyFilter {
  Span<const Index> group;  ///< by body; of one group at or above zero: not
  IgnoredPairs held;        ///< by bodies

  SCREE_HD bool may_touch(Index a, Index b) const {
    return !(group[a] >= 0 && group[a] == group[b]) && !held.contains(a, b);
  }
};

/// Pairs of bodies of one place in the sweep: with those behind it along x, and with large bodies.
struct SweepBodies {
  static constexpr const char* name = "affine_sweep_bodies";
  Span<const Bounds> bounds;
  Span<const Index> order;  ///< listed bodies along x, then large ones
  Index swept_count = 0;    ///< of these, the first ones
  BodyFilter filter;
  double distance = 0;
  Span<Index> count;  ///< out, without `begin`
  Span<const Offset> begin;
  Span<std::uint64_t> pair;  ///< out, with it: names of pairs
  std::uint64_t bodies = 0;

  SCREE_HD void operator()(Index i) const {
    const Index own = order[i];
    const Bounds b = bounds[own];
    Index found = 0;
    const auto take = [&](Index other) {
      if (!b.near(bounds[other], distance) || !filter.may_touch(own, other)) return;
      if (!begin.empty()) {
        const Index low = own < other ? own : other, high = own < other ? other : own;
        pair[begin[i] + found] =
            static_cast<std::uint64_t>(low) * bodies + static_cast<std::uint64_t>(high);
      }
      ++found;
    };
    const auto all = static_cast<Index>(order.size);
    if (i < swept_count) {
      for (Index k = i + 1; k < swept_count; ++k) {
        if (bounds[order[k]].low.x > b.high.x + distance) break;
        take(order[k]);
      }
      for (Index k = swept_count; k < all; ++k) take(order[k]);
    } else {
      for (Index k = i + 1; k < all; ++k) take(order[k]);
    }
    if (begin.empty()) count[i] = found;
  }
};

/// Features of a pair of bodies that are searched for: corners of both, and the edges of the one that has fewer.
struct CountFeatures {
  static constexpr const char* name = "affine_count_features";
  SurfacesView surfaces;
  Span<const std::uint64_t> pair;
  std::uint64_t bodies = 0;
  Span<BodyPair> body_pair;  ///< out
  Span<Index> count;         ///< out

  SCREE_HD void operator()(Index i) const {
    BodyPair p;
    p.body[0] = static_cast<Index>(pair[i] / bodies);
    p.body[1] = static_cast<Index>(pair[i] % bodies);
    body_pair[i] = p;
    const SurfaceRecord &a = surfaces.surface(p.body[0]), &b = surfaces.surface(p.body[1]);
    count[i] = a.corner_count + b.corner_count +
               (a.edge_count < b.edge_count ? a.edge_count : b.edge_count);
  }
};

/// Near pairs of one feature, counted or written. Bytes: the tree of the other body, from the caches.
struct SearchFeature {
  static constexpr const char* name = "affine_search_feature";
  SurfacesView surfaces;
  Span<const AffineVec> from, to;
  Span<const Bounds> bounds;  ///< by body
  Span<const BodyPair> body_pair;
  Span<const Offset> item_begin;  ///< of body pairs
  double distance = 0;
  Span<Index> count;  ///< out, without `begin`
  Span<const Offset> begin;
  Span<NearPair> found;  ///< out, with it

  SCREE_HD Index pair_of(Index item) const {
    Index low = 0, high = static_cast<Index>(body_pair.size);
    while (high - low > 1) {
      const Index middle = low + (high - low) / 2;
      if (item_begin[middle] <= item)
        low = middle;
      else
        high = middle;
    }
    return low;
  }

  SCREE_HD void operator()(Index item) const {
    const Index p = pair_of(item);
    auto feature = static_cast<Index>(item - item_begin[p]);
    const Index a = body_pair[p].body[0], b = body_pair[p].body[1];
    const SurfaceRecord &sa = surfaces.surface(a), &sb = surfaces.surface(b);
    NearPair pair;
    pair.bodies = p;
    Index hits = 0;
    if (feature < sa.corner_count) {
      pair.vertex[0] = sa.first_corner + feature;
      hits = against_triangles(a, b, pair, item);
    } else if ((feature -= sa.corner_count) < sb.corner_count) {
      pair.is_swapped = true;
      pair.vertex[0] = sb.first_corner + feature;
      hits = against_triangles(b, a, pair, item);
    } else {
      feature -= sb.corner_count;
      pair.kind = PairKind::edge_edge;
      pair.is_swapped = !(sa.edge_count < sb.edge_count);
      const Index own = pair.is_swapped ? b : a, other = pair.is_swapped ? a : b;
      const EdgeCorners& edge = surfaces.edges[surfaces.surface(own).first_edge + feature];
      pair.vertex[0] = edge.v[0], pair.vertex[1] = edge.v[1];
      hits = against_edges(own, other, pair, item);
    }
    if (begin.empty()) count[item] = hits;
  }

  SCREE_HD Index against_triangles(Index own, Index other, NearPair& pair, Index item) const {
    const Index corner[1] = {pair.vertex[0]};
    const Bounds box = swept_corners(from[own], to[own], surfaces.corners, corner);
    Index hits = 0;
    descend(other, surfaces.surface(other).triangle_root, box, [&](Index place) {
      const TriangleCorners& t = surfaces.triangles[place];
      if (!box.near(swept_corners(from[other], to[other], surfaces.corners, t.v), distance)) return;
      for (int k = 0; k < 3; ++k) pair.vertex[1 + k] = t.v[k];
      if (!begin.empty()) found[begin[item] + hits] = pair;
      ++hits;
    });
    return hits;
  }
  SCREE_HD Index against_edges(Index own, Index other, NearPair& pair, Index item) const {
    const Index corner[2] = {pair.vertex[0], pair.vertex[1]};
    const Bounds box = swept_corners(from[own], to[own], surfaces.corners, corner);
    Index hits = 0;
    descend(other, surfaces.surface(other).edge_root, box, [&](Index place) {
      const EdgeCorners& e = surfaces.edges[place];
      if (!box.near(swept_corners(from[other], to[other], surfaces.corners, e.v), distance)) return;
      pair.vertex[2] = e.v[0], pair.vertex[3] = e.v[1];
      if (!begin.empty()) found[begin[item] + hits] = pair;
      ++hits;
    });
    return hits;
  }

  /// Calls visit(place) for features of a tree whose leaves are near a box.
  template <class Visit>
  SCREE_HD void descend(Index body, Index root, const Bounds& box, Visit visit) const {
    if (!box.near(bounds[body], distance)) return;
    const AffineVec &start = from[body], &end = to[body];
    Index stack[kMostTreeDepth];
    int size = 0;
    stack[size++] = root;
    while (size > 0) {
      const TreeNode& node = surfaces.nodes[stack[--size]];
      if (!box.near(swept(start, end, node.center, node.half), distance)) continue;
      if (node.count > 0) {
        for (Index k = 0; k < node.count; ++k) visit(node.first + k);
      } else {
        stack[size++] = node.first + 1;
        stack[size++] = node.first;
      }
    }
  }
};

/// Where the near pairs of bodies are.
struct RangeOfPair {
  static constexpr const char* name = "affine_range_of_pair";
  Span<const Offset> item_begin, begin;
  Span<BodyPair> body_pair;

  SCREE_HD void operator()(Index p) const {
    body_pair[p].begin = static_cast<Index>(begin[item_begin[p]]);
    body_pair[p].end = static_cast<Index>(begin[item_begin[p + 1]]);
  }
};

}  // namespace scree::affine
