#pragma once
// Near pairs of features of two bodies. Blocks of some 32 features of one body are tested with those of the other, and then the
// features of blocks that come near each other: so there is enough to do at a time for two bodies of many features as for many
// bodies of few, and what is done together takes about as long.
// All lists are counted before they are written, and elements without room are left out: the counts tell how much is needed.

#include <numeric>

#include "kernels/affine/body_tree.h"
#include "kernels/backend/ordered_lists.h"
#include "kernels/math/bits.h"

namespace scree::affine {

/// Two bodies whose boxes are near each other.
struct Candidate {
  Index body[2] = {};  ///< the first is lower
  Index small = 0;     ///< which of them is smaller: 0 or 1

  SCREE_HD Index own() const { return body[small]; }
  SCREE_HD Index other() const { return body[1 - small]; }
};

/// A block of the smaller body of a candidate, and one of the other that it comes near.
struct BlockPair {
  Index candidate = 0;
  Index own = 0, other = 0;  ///< places in the list of blocks
};

/// Elements that lists would have if there were room, and rooms.
struct SearchCounts {
  static constexpr int kLists = 4, kTests = 1, kBlocks = 2, kPairs = 3;
  Offset bodies = 0;    ///< pairs of near bodies
  Offset tests = 0;     ///< of blocks of these, see BlockTests
  Offset blocks = 0;    ///< pairs of blocks that are near each other
  Offset pairs = 0;     ///< near pairs
  Offset touching = 0;  ///< pairs of bodies that have some, never more than `bodies`

  SCREE_HD Offset& of(int list) {
    return list == 0 ? bodies : list == kTests ? tests : list == kBlocks ? blocks : pairs;
  }
};

/// Last sum of a list, and all elements of it that there was room for.
SCREE_HD inline Offset all_of(Span<const Offset> begin) { return begin[begin.size - 1]; }
SCREE_HD inline Offset at_most(Offset x, Offset most) { return x < most ? x : most; }
SCREE_HD inline Offset held_of(Span<const Offset> begin, Offset room) {
  return at_most(all_of(begin), room);
}

/// How candidates, tests, blocks and pairs hang together: running sums, each with one element more than there is room for.
struct SearchSums {
  Span<const Offset> bodies;  ///< pairs of bodies, by what they were found from
  Span<const Offset> tests;   ///< by candidate
  Span<const Offset> blocks;  ///< pairs of blocks, by test
  Span<const Offset> pairs;   ///< by pair of blocks, or by its features
  Index slots = 1;            ///< sums of pairs that a pair of blocks has

  /// First near pair of a candidate, or of those behind it.
  SCREE_HD Index first_pair(Index candidate) const {
    const Offset test = at_most(tests[candidate], blocks.size - 1);
    const Offset item = at_most(blocks[test] * slots, pairs.size - 1);
    return static_cast<Index>(pairs[item]);
  }
};

/// What all searches read.
struct SearchBodies {
  SurfacesView surfaces;
  Span<const AffineVec> from, to;
  Span<const BodyBox> boxes;
  Span<const Candidate> candidates;
  Span<const RelativeWay> ways;  ///< of the smaller body of each as the other sees it
  double distance = 0;

  /// By how much boxes are widened so that all near pairs are found whatever rounding does.
  SCREE_HD double reach(double rounding) const { return (1 + kRounding) * distance + rounding; }
  SCREE_HD const TreeNode& block(Index place) const {
    return surfaces.nodes[surfaces.blocks[place]];
  }
};

/// Tests of blocks of candidates, in their order: of each block of the smaller body with those of the other that hold what its
/// features may touch, `run` of them at a time.
struct BlockTests {
  Span<const Offset> begin;  ///< running sums, by candidate
  Index run = 1;

  struct Test {
    Index own = 0;             ///< place in the list of blocks
    Index first = 0, end = 0;  ///< places of those of the other
  };

  SCREE_HD bool is_test(Index item) const { return item < all_of(begin); }
  SCREE_HD Index candidate(Index item) const {
    return first_not_below(begin, 0, static_cast<Index>(begin.size),
                           static_cast<Offset>(item) + 1) -
           1;
  }
  /// @param p  its candidate
  SCREE_HD Test test(Index item, Index p, const SearchBodies& at) const {
    const SurfaceRecord& own = at.surfaces.surface(at.candidates[p].own());
    const SurfaceRecord& other = at.surfaces.surface(at.candidates[p].other());
    Offset rest = item - begin[p];
    int kind = 0;
    for (; kind < kKinds - 1; ++kind) {
      const Offset tests = tests_of(own, other, kind);
      if (rest < tests) break;
      rest -= tests;
    }
    const Offset runs = runs_of(other, kind);
    const Offset skipped = rest % runs * run;
    const Index end = other.block[against(kind) + 1];
    Test t;
    t.own = own.block[kind] + static_cast<Index>(rest / runs);
    t.first = other.block[against(kind)] + static_cast<Index>(skipped);
    t.end = end - t.first > run ? t.first + run : end;
    return t;
  }
  SCREE_HD Offset count(const SurfaceRecord& own, const SurfaceRecord& other) const {
    Offset sum = 0;
    for (int kind = 0; kind < kKinds; ++kind) sum += tests_of(own, other, kind);
    return sum;
  }

 private:
  static constexpr int kKinds = 3;  ///< corners, edges and triangles
  static SCREE_HD int against(int kind) { return 2 - kind; }
  SCREE_HD Offset runs_of(const SurfaceRecord& other, int kind) const {
    const Index blocks = other.block[against(kind) + 1] - other.block[against(kind)];
    return blocks == 0 ? 0 : (blocks - 1) / run + 1;
  }
  SCREE_HD Offset tests_of(const SurfaceRecord& own, const SurfaceRecord& other, int kind) const {
    return (own.block[kind + 1] - own.block[kind]) * runs_of(other, kind);
  }
};

/// Candidates by their numbers, and how many tests each has. Bytes a candidate: 8 and 450 of its bodies read, 260 written.
struct SetCandidates {
  static constexpr const char* name = "affine_set_candidates";
  /// More tests of one candidate are not told: so many never have room.
  static constexpr Offset kMostTests = Offset{1} << 30;
  SearchBodies at;
  Span<const std::uint64_t> number;
  Span<const Offset> found;    ///< running sums of pairs of bodies
  Index run = 1;               ///< see BlockTests
  Span<Candidate> candidates;  ///< out
  Span<RelativeWay> ways;      ///< out
  Span<Index> tests;           ///< out, 0 behind the last candidate

  SCREE_HD void operator()(Index p) const {
    if (p >= held_of(found, number.size)) {
      tests[p] = 0;
      return;
    }
    const auto n = static_cast<std::uint64_t>(at.boxes.size);
    Candidate c;
    c.body[0] = static_cast<Index>(number[p] / n);
    c.body[1] = static_cast<Index>(number[p] % n);
    c.small = at.boxes[c.body[1]].radius < at.boxes[c.body[0]].radius ? 1 : 0;
    candidates[p] = c;
    const Index own = c.own(), other = c.other();
    const SurfaceRecord &s = at.surfaces.surface(own), &o = at.surfaces.surface(other);
    ways[p] = {at.from[own],
               at.to[own],
               s.radius,
               at.from[other],
               at.to[other],
               o.radius,
               at.reach(at.boxes[own].rounding + at.boxes[other].rounding)};
    const Offset count = BlockTests{{}, run}.count(s, o);
    tests[p] = static_cast<Index>(at_most(count, kMostTests));
  }
};

/// Pairs of blocks that come near each other, counted or written. A test of many blocks goes down the tree that they are of.
/// Bytes: nodes of 32, from the caches; 4 or 12 written.
struct FindBlocks {
  static constexpr const char* name = "affine_find_blocks";
  static constexpr Index kSerialBelow = 64;
  SearchBodies at;
  BlockTests tests;
  Span<Index> count;         ///< out, without `begin`
  Span<const Offset> begin;  ///< running sum of count
  Span<BlockPair> found;     ///< out, with `begin`

  SCREE_HD void operator()(Index item) const {
    const bool is_count = begin.empty();
    if (!tests.is_test(item)) {
      if (is_count) count[item] = 0;
      return;
    }
    if (!is_count && begin[item] == begin[item + 1]) return;
    const Index p = tests.candidate(item);
    const BlockTests::Test t = tests.test(item, p, at);
    if (!is_count && t.end == t.first + 1) {
      put(begin[item], {p, t.own, t.first});
      return;
    }
    const Index hits = search(p, t, is_count ? -1 : begin[item]);
    if (is_count) count[item] = hits;
  }

 private:
  SCREE_HD Index search(Index p, const BlockTests::Test& t, Offset place) const {
    const BodySpaceBox seen = at.ways[p].around(at.block(t.own));
    const Span<const Index> blocks = at.surfaces.blocks;
    Index hits = 0, k = t.first;
    Index node = t.end == t.first + 1 ? blocks[k] : top_above(k);
    while (k < t.end) {
      const TreeNode n = at.surfaces.nodes[node];
      const bool is_near = seen.meets(n), is_block = node == blocks[k];
      if (is_near && is_block) {
        if (place >= 0) put(place + hits, {p, t.own, k});
        ++hits;
      }
      if (is_near && !is_block) {
        ++node;
        continue;
      }
      node = n.after(node);
      k = is_block ? k + 1 : first_not_below(blocks, k, t.end, node);
    }
    return hits;
  }
  /// The highest node whose first block this is: it lies behind what the block before it holds.
  SCREE_HD Index top_above(Index block) const {
    if (block == 0) return 0;
    const Index before = at.surfaces.blocks[block - 1];
    return at.surfaces.nodes[before].after(before);
  }
  SCREE_HD void put(Offset place, const BlockPair& pair) const {
    if (place < found.size) found[place] = pair;
  }
};

/// A bit for each feature of a block: the first is the lowest.
using BlockBits = std::uint32_t;

/// A feature of the smaller body of a candidate, as its partners are looked for.
class SoughtFeature {
 public:
  SCREE_HD SoughtFeature(const SearchBodies& at, Index candidate, Index feature)
      : at_(at),
        candidate_(candidate),
        feature_(at.surfaces.features[feature]),
        seen_(at.ways[candidate].around(at.surfaces.corners, feature_)) {}

  /// Which features of a block of the other body are near it. One test after the other goes through all that the one before has
  /// left, so that features of a block that are looked for at a time do the same.
  SCREE_HD BlockBits near(Index block) {
    BlockBits met = leaves(block);
    const Index first = at_.block(block).begin;
    BlockBits bits = 0;
    for (; met != 0; met &= met - 1) {
      const int k = lowest_bit(met);
      if (seen_.meets(at_.surfaces.corners, at_.surfaces.features[first + k])) bits |= 1u << k;
    }
    if (bits == 0) return 0;
    const Candidate c = at_.candidates[candidate_];
    if (!has_box_) box_ = swept(at_.from[c.own()], at_.to[c.own()], at_.surfaces.corners, feature_);
    has_box_ = true;
    const AffineVec &from = at_.from[c.other()], &to = at_.to[c.other()];
    BlockBits near = 0;
    for (; bits != 0; bits &= bits - 1) {
      const int k = lowest_bit(bits);
      if (swept_near(box_, from, to, at_.surfaces.corners, at_.surfaces.features[first + k],
                     at_.distance))
        near |= 1u << k;
    }
    return near;
  }

 private:
  /// Features of leaves whose boxes it meets.
  SCREE_HD BlockBits leaves(Index block) const {
    Index node = at_.surfaces.blocks[block];
    const TreeNode top = at_.surfaces.nodes[node];
    const Index end = top.after(node);
    BlockBits bits = 0;
    while (node < end) {
      const TreeNode n = at_.surfaces.nodes[node];
      const bool is_met = seen_.meets(n);
      if (is_met && n.is_leaf()) bits |= ((1u << n.feature_count()) - 1) << (n.begin - top.begin);
      node = is_met ? node + 1 : n.after(node);
    }
    return bits;
  }

  const SearchBodies& at_;
  Index candidate_;
  Feature feature_;
  BodySpaceBox seen_;
  Bounds box_;  ///< of its way in the world, once it is asked for
  bool has_box_ = false;
};

/// What pairs of blocks have near: of each feature of the first those of the second.
struct FoundFeatures {
  Span<const Offset> begin;     ///< running sums of pairs of blocks, by test
  Span<const BlockPair> pairs;  ///< those that there was room for
  Span<BlockBits> near;         ///< [kBlockFeatures x pairs]

  SCREE_HD Index all() const { return static_cast<Index>(held_of(begin, pairs.size)); }
};

/// Near pairs of a feature with those of a block. Items: kBlockFeatures a pair of blocks. Bytes: nodes of 32, features of 16 and
/// their corners of 24, from the caches; 8 written.
struct SearchBlockPair {
  static constexpr const char* name = "affine_search_block_pair";
  static constexpr int kBlockThreads = kWaitingThreads;
  SearchBodies at;
  FoundFeatures found;
  Span<Index> count;  ///< out: by item

  SCREE_HD void operator()(Index item) const {
    const Index k = item / kBlockFeatures;
    BlockBits bits = 0;
    if (k < found.all()) {
      const BlockPair pair = found.pairs[k];
      const Index feature = at.block(pair.own).begin + item % kBlockFeatures;
      if (feature < at.block(pair.own + 1).begin)
        bits = SoughtFeature(at, pair.candidate, feature).near(pair.other);
    }
    found.near[item] = bits;
    count[item] = count_bits(bits);
  }
};

/// The same, where one item goes through all pairs that a test has found: what is known of a feature serves for all of them, and
/// leaves that are far from all of the other body are left out. Tests that find much lie beside each other, so items take them
/// crosswise: a range of items has some of all. Bytes: as of SearchBlockPair.
struct SearchTest {
  static constexpr const char* name = "affine_search_test";
  static constexpr Index kSerialBelow = 64;
  SearchBodies at;
  FoundFeatures found;
  Span<Index> count;  ///< out, by pair of blocks: those that no test has are not written
  Index step = 1;     ///< between tests of two items: prime to their number

  /// @param tests  their number
  static Index step_of(Index tests) {
    auto step = static_cast<Index>(0.618 * tests);
    while (std::gcd(step, tests) != 1) ++step;
    return step;
  }
  SCREE_HD void operator()(Index item) const {
    const auto test = static_cast<Index>(Offset{item} * step % (found.begin.size - 1));
    const Offset all = found.pairs.size;
    const auto begin = static_cast<Index>(at_most(found.begin[test], all));
    const auto end = static_cast<Index>(at_most(found.begin[test + 1], all));
    if (begin == end) return;
    for (Index k = begin; k < end; ++k) {
      count[k] = 0;
      for (Index slot = 0; slot < kBlockFeatures; ++slot) found.near[kBlockFeatures * k + slot] = 0;
    }
    const BlockPair pair = found.pairs[begin];
    const RelativeWay& way = at.ways[pair.candidate];
    const SurfaceRecord& other = at.surfaces.surface(at.candidates[pair.candidate].other());
    Index node = at.surfaces.blocks[pair.own];
    const TreeNode top = at.surfaces.nodes[node];
    const Index stop = top.after(node);
    const TreeNode against =
        at.surfaces.nodes[other.tree[3 - at.surfaces.features[top.begin].count]];
    while (node < stop) {
      const TreeNode n = at.surfaces.nodes[node];
      if (!way.around(n).meets(against)) {
        node = n.after(node);
        continue;
      }
      ++node;
      if (!n.is_leaf()) continue;
      for (Index feature = n.begin; feature < n.begin + n.feature_count(); ++feature)
        search(pair.candidate, feature, feature - top.begin, begin, end);
    }
  }

 private:
  SCREE_HD void search(Index candidate, Index feature, Index slot, Index begin, Index end) const {
    SoughtFeature sought(at, candidate, feature);
    for (Index k = begin; k < end; ++k) {
      const BlockBits bits = sought.near(found.pairs[k].other);
      found.near[kBlockFeatures * k + slot] = bits;
      count[k] += count_bits(bits);
    }
  }
};

/// Lists near pairs. Items: as `slots` tells, a pair of blocks or its features, or `parts` of these. Bytes: 8 an item, 4 a feature;
/// 24 written a pair.
struct PlacePairs {
  static constexpr const char* name = "affine_place_pairs";
  SearchBodies at;
  FoundFeatures from;
  Index slots = 1;              ///< of a pair of blocks
  Index parts = 1;              ///< items of a slot, if it is one feature: each has some bits of it
  Span<const Offset> begin;     ///< running sum of near pairs, by slot
  Span<const Offset> touching;  ///< by candidate: those before it that have near pairs
  Span<NearPair> found;         ///< out

  SCREE_HD void operator()(Index item) const {
    const Index slot = item / parts, part = item % parts;
    Offset place = begin[slot];
    if (place == begin[slot + 1]) return;
    const Index features = kBlockFeatures / slots;
    const BlockPair blocks = from.pairs[slot / slots];
    const Index own = at.block(blocks.own).begin, other = at.block(blocks.other).begin;
    const Index bodies = static_cast<Index>(touching[blocks.candidate]);
    const bool is_small_first = at.candidates[blocks.candidate].small == 0;
    for (Index k = 0; k < features; ++k) {
      const BlockBits all = from.near[features * slot + k];
      BlockBits bits = all & bits_of(part);
      place += count_bits(all & below(part));
      if (bits == 0) continue;
      const Feature feature = at.surfaces.features[own + slot % slots * features + k];
      for (; bits != 0; bits &= bits - 1) {
        const NearPair pair = pair_of(feature, at.surfaces.features[other + lowest_bit(bits)],
                                      bodies, is_small_first);
        if (place < found.size) found[place] = pair;
        ++place;
      }
    }
  }

 private:
  /// Bits of a part, and those of the parts before it.
  SCREE_HD BlockBits bits_of(Index part) const { return below(part + 1) & ~below(part); }
  SCREE_HD BlockBits below(Index part) const {
    const Index bits = kBlockFeatures / parts * part;
    return bits == kBlockFeatures ? ~BlockBits{0} : (BlockBits{1} << bits) - 1;
  }
  /// Corners come before triangles, and of two edges that of the first body before the other.
  static SCREE_HD NearPair pair_of(const Feature& own, const Feature& other, Index bodies,
                                   bool is_small_first) {
    const bool own_first = own.count == 2 ? is_small_first : own.count == 1;
    const Feature &first = own_first ? own : other, &second = own_first ? other : own;
    NearPair pair;
    pair.kind = own.count == 2 ? PairKind::edge_edge : PairKind::point_triangle;
    pair.vertex[0] = first.corner[0];
    pair.vertex[1] = own.count == 2 ? first.corner[1] : second.corner[0];
    pair.vertex[2] = second.corner[own.count == 2 ? 0 : 1];
    pair.vertex[3] = second.corner[own.count == 2 ? 1 : 2];
    pair.bodies = bodies;
    pair.is_swapped = own_first != is_small_first;
    return pair;
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
    counts->tests = all_of(sums.tests);
    counts->blocks = all_of(sums.blocks);
    counts->pairs = all_of(sums.pairs);
    counts->touching = all_of(touching);
  }
};

}  // namespace scree::affine
