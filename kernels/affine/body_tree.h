#pragma once
// Pairs of bodies whose boxes over their ways are near each other. Bodies are sorted along a curve through space, and eight
// neighbors on it make a node, eight of these another one, and so on: a tree that needs no links and that one pass a level builds.
// Each body looks for larger ones, so that the ground does not look for all that lies on it; nodes know their largest body.

#include "kernels/affine/surface_tree.h"
#include "kernels/math/morton.h"
#include "kernels/narrow_phase/ignored_pairs.h"

namespace scree::affine {

/// A body along its way.
struct BodyBox {
  Bounds box;           ///< holds all corners
  double radius = 0;    ///< of its surface [m]
  double rounding = 0;  ///< rounding_of() it [m]
};

/// Boxes of bodies; the box about all of them as a reduction. Bytes a body: 192 read, 64 written, and its outline from the caches.
struct BoundBodies {
  static constexpr const char* name = "affine_bound_bodies";
  static constexpr Index kSerialBelow = 64;
  SurfacesView surfaces;
  Span<const AffineVec> from, to;
  Span<BodyBox> boxes;  ///< out

  SCREE_HD Bounds operator()(Index body) const {
    const SurfaceRecord& s = surfaces.surface(body);
    const AffineVec start = from[body], end = to[body];
    BodyBox b;
    for (Index k = s.outline_begin; k < s.outline_end; ++k)
      b.box.add(swept(start, end, surfaces.outline[k]));
    b.radius = s.radius;
    b.rounding = rounding_of(start, end, s.radius);
    b.box = b.box.widened(b.rounding);
    boxes[body] = b;
    return b.box;
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

/// Two bodies as one number, in the order of the lower and then of the higher one.
SCREE_HD inline std::uint64_t pair_number(Index a, Index b, Index body_count) {
  const Index low = a < b ? a : b, high = a < b ? b : a;
  return static_cast<std::uint64_t>(low) * static_cast<std::uint64_t>(body_count) +
         static_cast<std::uint64_t>(high);
}

/// Where near pairs of bodies go once they are counted.
struct BodyPairPlaces {
  Span<Index> count;          ///< out, without `begin`
  Span<const Offset> begin;   ///< running sum of count
  Span<std::uint64_t> found;  ///< out, with it: numbers of pairs; those without room are left out

  SCREE_HD bool is_count() const { return begin.empty(); }
  SCREE_HD void put(Index item, Index k, std::uint64_t number) const {
    if (is_count()) return;
    const Offset place = begin[item] + k;
    if (place < found.size) found[place] = number;
  }
};

/// Of few bodies: each with each. Item a * count + b. Bytes: boxes, from the caches; 4 or 8 written.
struct TryBodies {
  static constexpr const char* name = "affine_try_bodies";
  Span<const BodyBox> boxes;
  BodyFilter filter;
  double distance = 0;
  BodyPairPlaces places;

  SCREE_HD void operator()(Index item) const {
    const auto n = static_cast<Index>(boxes.size);
    const Index a = item / n, b = item % n;
    const bool is_near =
        a < b && boxes[a].box.near(boxes[b].box, distance) && filter.may_touch(a, b);
    if (is_near) places.put(item, 0, pair_number(a, b, n));
    if (places.is_count()) places.count[item] = is_near ? 1 : 0;
  }
};

/// Bits of the curve along an axis: sorts take a pass for each eight of all three.
inline constexpr int kCurveBits = 16;

/// Places of bodies on the curve. Bytes a body: 64 read, 12 written.
struct PlaceOnCurve {
  static constexpr const char* name = "affine_place_on_curve";
  Span<const BodyBox> boxes;
  const Bounds* all;
  Span<std::uint64_t> key;  ///< out
  Span<Index> order;        ///< out

  SCREE_HD void operator()(Index body) const {
    const Bounds &b = boxes[body].box, &a = *all;
    std::uint32_t cell[3];
    for (int k = 0; k < 3; ++k) {
      const double cells = 1 << kCurveBits;
      const double at = cells * (0.5 * (b.low[k] + b.high[k]) - a.low[k]) / (a.high[k] - a.low[k]);
      cell[k] = !(at > 0) ? 0 : static_cast<std::uint32_t>(at < cells ? at : cells - 1);
    }
    key[body] = morton_code(cell[0], cell[1], cell[2]);
    order[body] = body;
  }
};

/// A node: the box about its bodies and the radius of the largest.
struct BodyNode {
  Bounds box;
  double radius = 0;
};

/// Children of a node.
inline constexpr Index kBodyFan = 8;

struct BodyTree {
  static constexpr int kMostLevels = 12;  ///< 8^11 bodies have numbers no more
  Span<const BodyBox> boxes;              ///< by body
  Span<const Index> order;                ///< bodies, along the curve: level 0
  Span<BodyNode> nodes;                   ///< of level 1, then those of level 2, ...
  Index begin[kMostLevels] = {};          ///< of a level in `nodes`
  Index count[kMostLevels] = {};          ///< of a level
  int top = 0;                            ///< the level of one node, at least 1

  SCREE_HD BodyNode node(int level, Index i) const {
    if (level > 0) return nodes[begin[level] + i];
    const BodyBox& b = boxes[order[i]];
    return {b.box, b.radius};
  }
};

/// Levels of a tree, without its arrays. @return nodes of all levels but the bodies
inline Index set_levels(BodyTree& tree, Index bodies) {
  Index total = 0;
  tree.count[0] = bodies;
  for (int level = 1; level < BodyTree::kMostLevels; ++level) {
    tree.top = level;
    tree.begin[level] = total;
    tree.count[level] = (tree.count[level - 1] + kBodyFan - 1) / kBodyFan;
    total += tree.count[level];
    if (tree.count[level] == 1) break;
  }
  return total;
}

/// Nodes of a level. Bytes a node: 8 x 56 read, 56 written.
struct JoinBodies {
  static constexpr const char* name = "affine_join_bodies";
  BodyTree tree;
  int level = 1;

  SCREE_HD void operator()(Index i) const {
    BodyNode joined;
    const Index first = i * kBodyFan, all = tree.count[level - 1];
    for (Index k = first; k < first + kBodyFan && k < all; ++k) {
      const BodyNode child = tree.node(level - 1, k);
      joined.box.add(child.box);
      joined.radius = child.radius > joined.radius ? child.radius : joined.radius;
    }
    tree.nodes[tree.begin[level] + i] = joined;
  }
};

/// Pairs of a body with those that are larger, or as large with a higher number, counted or written. Bodies look in each node of a
/// level. Item: node of it x bodies + place on the curve.
struct FindBodies {
  static constexpr const char* name = "affine_find_bodies";
  static constexpr Index kSerialBelow = 64;
  BodyTree tree;
  int from = 1;  ///< the level
  BodyFilter filter;
  double distance = 0;
  BodyPairPlaces places;

  SCREE_HD void operator()(Index item) const {
    const Index own = tree.order[item % tree.count[0]];
    const BodyBox body = tree.boxes[own];
    Index hits = 0;
    int level = from;
    Index i = item / tree.count[0];
    for (;;) {
      const BodyNode node = tree.node(level, i);
      if (!(node.radius < body.radius) && body.box.near(node.box, distance)) {
        if (level > 0) {
          --level;
          i *= kBodyFan;
          continue;
        }
        const Index other = tree.order[i];
        if ((node.radius > body.radius || other > own) && filter.may_touch(own, other))
          places.put(item, hits++, pair_number(own, other, tree.count[0]));
      }
      ++i;
      while (level < from && (i % kBodyFan == 0 || i == tree.count[level])) {
        i = (i + kBodyFan - 1) / kBodyFan;
        ++level;
      }
      if (level == from) break;
    }
    if (places.is_count()) places.count[item] = hits;
  }
};

}  // namespace scree::affine
