#pragma once
// Near pairs of features of two bodies. Of each pair of bodies the smaller one has its features looked for in the trees of the
// other: in blocks of some 32, which take out what is far from the other body as a whole, and then one by one. So there is
// enough to do at a time for two bodies of many features as for many bodies of few.
// All lists are counted before they are written, and elements without room are left out: the counts tell how much is needed.

#include "kernels/affine/body_tree.h"
#include "kernels/backend/ordered_lists.h"

namespace scree::affine {

/// Two bodies whose boxes are near each other.
struct Candidate {
  Index body[2] = {};  ///< the first is lower
  Index small = 0;     ///< which of them is smaller: 0 or 1

  SCREE_HD Index own() const { return body[small]; }
  SCREE_HD Index other() const { return body[1 - small]; }
};

/// A feature of the smaller body of a candidate.
struct FeatureItem {
  Index candidate = 0, feature = 0;
};

/// Elements that lists would have if there were room, and rooms.
struct SearchCounts {
  static constexpr int kLists = 4, kPairs = 3;
  Offset bodies = 0;    ///< pairs of near bodies
  Offset blocks = 0;    ///< of these
  Offset features = 0;  ///< of blocks, that come near the other body
  Offset pairs = 0;     ///< near pairs
  Offset touching = 0;  ///< pairs of bodies that have some, never more than `bodies`

  SCREE_HD Offset& of(int list) {
    return list == 0 ? bodies : list == 1 ? blocks : list == 2 ? features : pairs;
  }
};

/// Last sum of a list, and all elements of it that there was room for.
SCREE_HD inline Offset all_of(Span<const Offset> begin) { return begin[begin.size - 1]; }
SCREE_HD inline Offset held_of(Span<const Offset> begin, Offset room) {
  return all_of(begin) < room ? all_of(begin) : room;
}

/// How candidates, blocks, features and pairs hang together: running sums, each with one element more than there is room for.
struct SearchSums {
  Span<const Offset> bodies;    ///< pairs of bodies, by what they were found from
  Span<const Offset> blocks;    ///< by candidate
  Span<const Offset> features;  ///< by block
  Span<const Offset> pairs;     ///< by item of a feature
  Index parts = 1;              ///< items of a feature, see SearchFeature

  /// First near pair of a candidate, or of those behind it.
  SCREE_HD Index first_pair(Index candidate) const {
    const Offset block = at_most(blocks[candidate], features.size - 1);
    const Offset item = at_most(features[block] * parts, pairs.size - 1);
    return static_cast<Index>(pairs[item]);
  }

 private:
  static SCREE_HD Offset at_most(Offset x, Offset most) { return x < most ? x : most; }
};

/// What both searches read.
struct SearchBodies {
  SurfacesView surfaces;
  Span<const AffineVec> from, to;
  Span<const BodyBox> boxes;
  Span<const Candidate> candidates;
  Span<const RelativeWay> ways;  ///< of the smaller body of each as the other sees it
  double distance = 0;

  /// By how much boxes are widened so that all near pairs are found whatever rounding does.
  SCREE_HD double reach(double rounding) const { return (1 + kRounding) * distance + rounding; }
};

/// Candidates by their numbers, and how many blocks each has. Bytes a candidate: 8 and 450 of its bodies read, 260 written.
struct SetCandidates {
  static constexpr const char* name = "affine_set_candidates";
  SearchBodies at;
  Span<const std::uint64_t> number;
  Span<const Offset> found;    ///< running sums of pairs of bodies
  Span<Candidate> candidates;  ///< out
  Span<RelativeWay> ways;      ///< out
  Span<Index> blocks;          ///< out, 0 behind the last candidate

  SCREE_HD void operator()(Index p) const {
    if (p >= held_of(found, number.size)) {
      blocks[p] = 0;
      return;
    }
    const auto n = static_cast<std::uint64_t>(at.boxes.size);
    Candidate c;
    c.body[0] = static_cast<Index>(number[p] / n);
    c.body[1] = static_cast<Index>(number[p] % n);
    c.small = at.boxes[c.body[1]].radius < at.boxes[c.body[0]].radius ? 1 : 0;
    candidates[p] = c;
    const Index own = c.own(), other = c.other();
    const SurfaceRecord& s = at.surfaces.surface(own);
    ways[p] = {at.from[own],
               at.to[own],
               s.radius,
               at.from[other],
               at.to[other],
               at.surfaces.surface(other).radius,
               at.reach(at.boxes[own].rounding + at.boxes[other].rounding)};
    blocks[p] = s.block_end - s.block_begin;
  }
};

/// Blocks of candidates, in their order.
struct BlockItems {
  Span<const Offset> blocks;  ///< running sums

  SCREE_HD bool is_block(Index item) const { return item < all_of(blocks); }
  SCREE_HD Index candidate(Index item) const {
    return first_not_below(blocks, 0, static_cast<Index>(blocks.size),
                           static_cast<Offset>(item) + 1) -
           1;
  }
  /// Its node. @param p  its candidate
  SCREE_HD Index node(Index item, Index p, const SearchBodies& at) const {
    const SurfaceRecord& own = at.surfaces.surface(at.candidates[p].own());
    return at.surfaces.blocks[own.block_begin + item - static_cast<Index>(blocks[p])];
  }
};

/// Features of a block that come near the other body. Bytes: up to 15 nodes of 32, from the caches.
struct SearchBlock {
  static constexpr const char* name = "affine_search_block";
  static constexpr Index kSerialBelow = 64;
  SearchBodies at;
  BlockItems items;
  Span<std::uint32_t> near;  ///< out, of each block: a bit for each feature
  Span<Index> count;         ///< out: of these

  SCREE_HD void operator()(Index item) const {
    if (!items.is_block(item)) {
      count[item] = 0;
      return;
    }
    const Index p = items.candidate(item);
    const RelativeWay way = at.ways[p];
    Index node = items.node(item, p, at);
    const Index first = at.surfaces.nodes[node].begin;
    Index stop = at.surfaces.nodes[node].after(node);
    const Index *tree = at.surfaces.surface(at.candidates[p].other()).tree,
                against = 3 - at.surfaces.features[first].count;
    if (tree[against] == tree[against + 1]) stop = node;  // it has no such features
    TreeNode all;
    if (node < stop) all = at.surfaces.nodes[tree[against]];
    std::uint32_t bits = 0;
    Index hits = 0;
    while (node < stop) {
      const TreeNode n = at.surfaces.nodes[node];
      if (!way.comes_near(n, all)) {
        node = n.after(node);
        continue;
      }
      ++node;
      if (!n.is_leaf()) continue;
      bits |= ((1u << n.feature_count()) - 1) << (n.begin - first);
      hits += n.feature_count();
    }
    near[item] = bits;
    count[item] = hits;
  }
};

/// Bits that are set below a place.
SCREE_HD inline int bits_below(std::uint32_t bits, int place) {
  int count = 0;
  for (std::uint32_t rest = bits & ((1u << place) - 1); rest != 0; rest &= rest - 1) ++count;
  return count;
}

/// Lists what SearchBlock found. Items: one a block, or one for each of its features. Bytes a block: 12 read; 8 written a feature.
struct ListFeatures {
  static constexpr const char* name = "affine_list_features";
  SearchBodies at;
  BlockItems items;
  Span<const std::uint32_t> near;
  Span<const Offset> begin;  ///< running sum of features
  Span<FeatureItem> found;   ///< out
  int parts = 1;             ///< items of a block

  SCREE_HD void operator()(Index of) const {
    const Index item = of / parts;
    if (!items.is_block(item) || begin[item] == begin[item + 1]) return;
    const Index p = items.candidate(item);
    const Index first = at.surfaces.nodes[items.node(item, p, at)].begin;
    const std::uint32_t bits = near[item];
    for (int k = of % parts; k < kBlockFeatures; k += parts) {
      if ((bits >> k & 1u) == 0) continue;
      const Offset place = begin[item] + bits_below(bits, k);
      if (place < found.size) found[place] = {p, first + k};
    }
  }
};

/// What features were found near: the first few of each, where there are no more.
struct FoundFeatures {
  static constexpr Index kKept = 16;
  Span<Index> feature;  ///< [kKept x room]
  Offset room = 0;

  SCREE_HD void put(Index item, Index k, Index value) const {
    if (k < kKept) feature[k * room + item] = value;
  }
  SCREE_HD Index at(Index item, Index k) const { return feature[k * room + item]; }
};

/// Near pairs of one feature, counted or written, in parts: each goes through so much of the other tree, as it lies in memory, so
/// that a device need not wait for the few features that meet most of it. Bytes: nodes of the other tree, 32 each, and the
/// corners of a few features, from the caches; 4 to 68 written, then read with 24 written a pair.
struct SearchFeature {
  static constexpr const char* name = "affine_search_feature";
  static constexpr Index kSerialBelow = 64;
  static constexpr int kBlockThreads = kWaitingThreads;
  SearchBodies at;
  Span<const Offset> features;  ///< running sums
  Span<const FeatureItem> items;
  FoundFeatures kept;
  Span<Index> count;            ///< out, without `begin`
  Span<const Offset> begin;     ///< running sum of count
  Span<const Offset> touching;  ///< by candidate: those before it that have near pairs
  Span<NearPair> found;         ///< out, with `begin`
  Index parts = 1;              ///< items of a feature

  SCREE_HD void operator()(Index item) const {
    if (item / parts >= all_of(features)) {
      if (begin.empty()) count[item] = 0;
    } else if (begin.empty()) {
      count[item] = search(item, -1);
    } else if (begin[item + 1] - begin[item] > FoundFeatures::kKept) {
      search(item, begin[item]);
    } else {
      const auto hits = static_cast<Index>(begin[item + 1] - begin[item]);
      for (Index k = 0; k < hits; ++k) put(begin[item] + k, item, kept.at(item, k));
    }
  }

 private:
  /// @param place  of the first pair in the list; -1: keeps the first few. @return how many there are
  SCREE_HD Index search(Index item, Offset place) const {
    const FeatureItem own_item = items[item / parts];
    const Candidate c = at.candidates[own_item.candidate];
    const Index own = c.own(), other = c.other();
    const Feature feature = at.surfaces.features[own_item.feature];
    const BodySpaceBox seen = at.ways[own_item.candidate].around(at.surfaces.corners, feature);
    Bounds box;  // of its way in the world, once it is asked for
    bool has_box = false;
    const SurfaceRecord& tree = at.surfaces.surface(other);
    const Index root = tree.tree[3 - feature.count], part = item % parts;
    const Offset nodes = tree.tree[4 - feature.count] - root;
    Index node = root + static_cast<Index>(nodes * part / parts);
    const Index stop = root + static_cast<Index>(nodes * (part + 1) / parts);
    Index hits = 0;
    while (node < stop) {
      const TreeNode n = at.surfaces.nodes[node];
      if (!seen.meets(n)) {
        node = n.after(node);
        continue;
      }
      ++node;
      if (!n.is_leaf()) continue;
      for (Index k = n.begin; k < n.begin + n.feature_count(); ++k) {
        const Feature against = at.surfaces.features[k];
        if (!seen.meets(at.surfaces.corners, against)) continue;
        if (!has_box) box = swept(at.from[own], at.to[own], at.surfaces.corners, feature);
        has_box = true;
        if (!swept_near(box, at.from[other], at.to[other], at.surfaces.corners, against,
                        at.distance))
          continue;
        if (place < 0) {
          kept.put(item, hits, k);
        } else {
          put(place + hits, item, k);
        }
        ++hits;
      }
    }
    return hits;
  }

  /// Corners come before triangles, and of two edges that of the first body before the other.
  SCREE_HD void put(Offset place, Index item, Index against) const {
    if (place >= found.size) return;
    const FeatureItem own_item = items[item / parts];
    const Index candidate = own_item.candidate, small = at.candidates[candidate].small;
    const Feature own = at.surfaces.features[own_item.feature];
    const Feature other = at.surfaces.features[against];
    const bool own_first = own.count == 2 ? small == 0 : own.count == 1;
    const Feature first = own_first ? own : other, second = own_first ? other : own;
    NearPair pair;
    pair.kind = own.count == 2 ? PairKind::edge_edge : PairKind::point_triangle;
    pair.vertex[0] = first.corner[0];
    pair.vertex[1] = own.count == 2 ? first.corner[1] : second.corner[0];
    pair.vertex[2] = second.corner[own.count == 2 ? 0 : 1];
    pair.vertex[3] = second.corner[own.count == 2 ? 1 : 2];
    pair.bodies = static_cast<Index>(touching[candidate]);
    pair.is_swapped = own_first != (small == 0);
    found[place] = pair;
  }
};

/// Whether a candidate has near pairs. Bytes a candidate: some 40 read, 4 written.
struct MarkTouching {
  static constexpr const char* name = "affine_mark_touching";
  SearchSums sums;
  Span<Index> mark;  ///< out
  SCREE_HD void operator()(Index p) const {
    mark[p] = sums.first_pair(p) < sums.first_pair(p + 1) ? 1 : 0;
  }
};

/// Pairs of bodies that have near pairs. Bytes a candidate: some 60 read, 16 written.
struct PlaceTouching {
  static constexpr const char* name = "affine_place_touching";
  SearchSums sums;
  Span<const Candidate> candidates;
  Span<const Offset> touching;  ///< running sum of marks
  Span<BodyPair> body_pairs;    ///< out
  SCREE_HD void operator()(Index p) const {
    if (touching[p] == touching[p + 1]) return;
    const Candidate c = candidates[p];
    body_pairs[touching[p]] = {{c.body[0], c.body[1]}, sums.first_pair(p), sums.first_pair(p + 1)};
  }
};

/// What the host has to know of a search.
struct SumUpSearch {
  static constexpr const char* name = "affine_sum_up_search";
  SearchSums sums;
  Span<const Offset> touching;
  SearchCounts* counts;  ///< out
  SCREE_HD void operator()(Index /*one*/) const {
    counts->bodies = all_of(sums.bodies);
    counts->blocks = all_of(sums.blocks);
    counts->features = all_of(sums.features);
    counts->pairs = all_of(sums.pairs);
    counts->touching = all_of(touching);
  }
};

}  // namespace scree::affine
