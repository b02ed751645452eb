#pragma once
// Lists of near pairs in backend memory.

#include <algorithm>
#include <limits>
#include <utility>

#include "collision/numbering.h"
#include "dynamics/affine/surface_tables.h"
#include "kernels/affine/near_search.h"

namespace scree::affine {

/// One host read a search. Lists are written into room for somewhat more than the last search needed; where that is not
/// enough the search is made again with more, so that none is ever cut short.
/// Memory: 24 bytes a near pair, 530 a pair of near blocks (150 on a processor), 12 a test of blocks, 320 a pair of near bodies, 130 a body.
/// Items of a device that look for near bodies take 12 each, 6 MB at most.
/// Each body costs its box and two ways down the tree of bodies; each pair of near bodies costs tests of blocks of 32 features of
/// the one with those of the other, on a processor two ways down a tree for each block of the smaller one; and each pair of near
/// blocks costs boxes of the features of one, and tests of each with the leaves of the other.
/// @tparam kSplits  whether features of a block have items of their own: a device has more threads than there are blocks
template <class B, bool kSplits = B::kIsDevice>
class NearPairs {
 public:
  /// @param most_tests  of blocks, if each can be of more blocks
  explicit NearPairs(B& b, Offset most_tests = 1 << 21)
      : most_tests_(most_tests),
        boxes_(b),
        all_(b, 1),
        key_(b),
        order_(b),
        nodes_(b),
        sort_(b),
        number_(b),
        unused_(b),
        count_(b),
        bodies_(b),
        tests_(b),
        blocks_(b),
        pairs_(b),
        touching_(b),
        candidate_(b),
        ways_(b),
        block_pair_(b),
        found_bits_(b),
        body_pair_(b),
        near_(b) {}

  /// Lists all pairs of features that come within a distance of each other while bodies move straight from one place to
  /// another, all at one time, but those of bodies that do not touch. Of others it lists some whose boxes come so near.
  /// @param from, to  by body
  /// @throws std::runtime_error when there are more than can be numbered
  void build(B& b, const SurfaceTables<B>& tables, Span<const AffineVec> from,
             Span<const AffineVec> to, double distance) {
    corners_ = tables.view().corners;
    const Index n = tables.body_count();
    found_ = SearchCounts{};
    if (n < 2) return;
    reserve_bodies(n);
    if (is_few(n)) {
      for_each(b, n, BoundBodies{tables.view(), from, to, boxes_.view(n)});
    } else {
      reduce<Bounds>(b, n, BoundBodies{tables.view(), from, to, boxes_.view(n)},
                     StoreResult<Bounds>{all_.data()});
      make_tree(b, n);
    }
    const SearchBodies at{tables.view(), from, to, boxes(n), {}, {}, distance};
    do {
      search(b, at, tables.filter());
      found_ = take_result<SearchCounts>(b);
    } while (!has_room());
  }

  /// Whether the last search found few pairs for what it looked at.
  bool finds_few() const { return found_.pairs <= 2 * found_.blocks; }

  NearPairsView view() const {
    return {near_.view(found_.pairs), body_pair_.view(found_.touching), corners_};
  }

 private:
  /// So few bodies are tested each with each, which is as fast as a tree and takes fewer launches.
  static constexpr Index kFew = kSplits ? 256 : 32;
  static constexpr bool is_few(Index bodies) { return bodies <= kFew; }
  /// Items of a pair of blocks: a device has one for each feature of the first.
  static constexpr Index kSlots = kSplits ? kBlockFeatures : 1;
  /// Items of each of these that write what was found.
  static constexpr Index kParts = kSplits ? 4 : 1;
  static constexpr Index kAllBlocks = std::numeric_limits<Index>::max();
  static constexpr Index kThreads = 1 << 19;  ///< that a device has, twice
  /// Level of the tree in whose nodes bodies look, in each by another item where a device has as many threads. All that some
  /// bodies find is in a few nodes: one way down the tree takes several times as long as they take at most.
  int search_level() const {
    int level = tree_.top;
    if constexpr (kSplits)
      while (level > 1 && Offset{tree_.count[0]} * tree_.count[level - 1] <= kThreads) --level;
    return level;
  }
  /// Items that look for pairs of bodies, whose levels are set if they are not few.
  Index finders(Index bodies) const {
    return bodies * (is_few(bodies) ? bodies : tree_.count[search_level()]);
  }
  /// Most items of one pass, and how many an element of a list has.
  static constexpr Offset kMostItems = std::numeric_limits<Index>::max() - 1;
  static constexpr Offset items_of(int list) {
    return list == SearchCounts::kBlocks ? kSlots * kParts : 1;
  }

  Span<const BodyBox> boxes(Index n) const { return boxes_.view(n); }

  void reserve_bodies(Index n) {
    boxes_.reserve_discard(n);
    if (!is_few(n)) {
      key_.reserve_discard(n);
      order_.reserve_discard(n);
      nodes_.reserve_discard(set_levels(tree_, n));
    }
    bodies_.reserve_discard(Offset{finders(n)} + 1);
  }

  void make_tree(B& b, Index n) {
    for_each(b, n, PlaceOnCurve{boxes(n), all_.data(), key_.view(n), order_.view(n)});
    sort_pairs(b, sort_, key_.view(n), order_.view(n), 3 * kCurveBits);
    tree_.boxes = boxes(n);
    tree_.order = std::as_const(order_).view(n);
    tree_.nodes = nodes_.view(set_levels(tree_, n));
    for (int level = 1; level <= tree_.top; ++level)
      for_each(b, tree_.count[level], JoinBodies{tree_, level});
  }

  /// Runs the search with the room that there is.
  void search(B& b, SearchBodies at, const BodyFilter& filter) {
    const auto candidates = static_cast<Index>(room_.bodies);
    const auto tests = static_cast<Index>(room_.tests);
    const auto blocks = static_cast<Index>(room_.blocks);
    reserve_lists();
    find_bodies(b, at, filter);
    const SearchSums sums = this->sums(static_cast<Index>(at.boxes.size));
    for_each(b, candidates,
             SetCandidates{at, std::as_const(number_).view(candidates), sums.bodies, run_,
                           candidate_.view(candidates), ways_.view(candidates),
                           count_.view(candidates)});
    add_up(b, candidates, tests_);
    at.candidates = std::as_const(candidate_).view(candidates);
    at.ways = std::as_const(ways_).view(candidates);

    FindBlocks find{at, {sums.tests, run_}, count_.view(tests), {}, {}};
    for_each(b, tests, find);
    add_up(b, tests, blocks_);
    find.begin = sums.blocks;
    find.found = block_pair_.view(blocks);
    for_each(b, tests, find);

    const FoundFeatures found{sums.blocks, std::as_const(block_pair_).view(blocks),
                              found_bits_.view(kBlockFeatures * Offset{blocks})};
    const Index items = kSlots * blocks;
    if constexpr (kSplits) {
      for_each(b, items, SearchBlockPair{at, found, count_.view(items)});
    } else {
      fill(b, count_.view(items), Index{0});
      for_each(b, tests, SearchTest{at, found, count_.view(items), SearchTest::step_of(tests)});
    }
    add_up(b, items, pairs_);
    for_each(b, candidates, MarkTouching{sums, count_.view(candidates)});
    add_up(b, candidates, touching_);
    const Span<const Offset> touching = running(touching_, candidates);
    for_each(b, candidates,
             PlaceTouching{sums, at.candidates, touching, body_pair_.view(candidates)});
    for_each(b, kParts * items,
             PlacePairs{at, found, kSlots, kParts, sums.pairs, touching, near_.view(room_.pairs)});
    for_each(b, 1, SumUpSearch{sums, touching, result_place<SearchCounts>(b)});
  }

  /// Numbers of pairs of near bodies, rising.
  void find_bodies(B& b, const SearchBodies& at, const BodyFilter& filter) {
    const auto n = static_cast<Index>(at.boxes.size);
    const auto room = static_cast<Index>(room_.bodies);
    if (is_few(n)) {
      find_with(b, finders(n), TryBodies{at.boxes, filter, at.reach(0), {}});
      return;
    }
    fill(b, number_.view(room), ~std::uint64_t{0});  // behind all others
    find_with(b, finders(n), FindBodies{tree_, search_level(), filter, at.reach(0), {}});
    sort_pairs(b, sort_, number_.view(room), unused_.view(room),
               bits_for(static_cast<std::uint64_t>(n) * static_cast<std::uint64_t>(n)));
  }
  template <class Find>
  void find_with(B& b, Index items, Find find) {
    find.places.count = count_.view(items);
    for_each(b, items, find);
    add_up(b, items, bodies_);
    find.places.begin = running(bodies_, items);
    find.places.found = number_.view(room_.bodies);
    for_each(b, items, find);
  }

  static Span<const Offset> running(const Buffer<B, Offset>& sums, Index count) {
    return sums.view(static_cast<Offset>(count) + 1);
  }
  void add_up(B& b, Index count, Buffer<B, Offset>& sums) {
    exclusive_scan(b, Span<const Index>(count_.view(count)),
                   sums.view(static_cast<Offset>(count) + 1));
  }
  SearchSums sums(Index n) const {
    return {running(bodies_, finders(n)), running(tests_, static_cast<Index>(room_.bodies)),
            running(blocks_, static_cast<Index>(room_.tests)),
            running(pairs_, kSlots * static_cast<Index>(room_.blocks)), kSlots};
  }

  void reserve_lists() {
    number_.reserve_discard(room_.bodies);
    unused_.reserve_discard(room_.bodies);
    candidate_.reserve_discard(room_.bodies);
    ways_.reserve_discard(room_.bodies);
    body_pair_.reserve_discard(room_.bodies);
    tests_.reserve_discard(room_.bodies + 1);
    touching_.reserve_discard(room_.bodies + 1);
    blocks_.reserve_discard(room_.tests + 1);
    block_pair_.reserve_discard(room_.blocks);
    found_bits_.reserve_discard(kBlockFeatures * room_.blocks);
    const Offset items = kSlots * room_.blocks;
    pairs_.reserve_discard(items + 1);
    near_.reserve_discard(room_.pairs);
    count_.reserve_discard(std::max({bodies_.capacity(), room_.bodies, room_.tests, items}));
  }

  /// Whether all that was found had room. Sets the rooms for the next search, which that many and a few more will have.
  bool has_room() {
    if (found_.tests > most_tests_ && run_ < kAllBlocks) {
      run_ =
          static_cast<Index>(std::min<Offset>(run_ * (found_.tests / most_tests_ + 1), kAllBlocks));
      return false;
    }
    bool fits = true;
    for (int list = 0; list < SearchCounts::kLists; ++list) {
      const Offset needed = found_.of(list);
      const Offset items = needed * items_of(list);
      checked_index(items, items <= kMostItems, "near pairs of affine bodies");
      fits = fits && needed <= room_.of(list);
    }
    for (int list = 0; list < SearchCounts::kLists; ++list) {
      const Offset needed = found_.of(list);
      // A list that was cut short, and those behind it, only grow: their numbers are too low.
      const Offset wanted = std::min(needed + needed / 4 + 256, kMostItems / items_of(list));
      // Room for pairs alone costs no items.
      const bool may_shrink = fits && list != SearchCounts::kPairs;
      room_.of(list) = may_shrink ? wanted : std::max(room_.of(list), wanted);
    }
    return fits;
  }

  Offset most_tests_;
  Span<const Vec3d> corners_;
  Buffer<B, BodyBox> boxes_;
  Buffer<B, Bounds> all_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> order_;
  Buffer<B, BodyNode> nodes_;
  SortSpace<B> sort_;
  BodyTree tree_;
  Buffer<B, std::uint64_t> number_;
  Buffer<B, Index> unused_;  ///< goes with the numbers as they are sorted
  Buffer<B, Index> count_;
  Buffer<B, Offset> bodies_, tests_, blocks_, pairs_, touching_;  ///< running sums
  Buffer<B, Candidate> candidate_;
  Buffer<B, RelativeWay> ways_;
  Buffer<B, BlockPair> block_pair_;
  Buffer<B, BlockBits> found_bits_;
  Buffer<B, BodyPair> body_pair_;
  Buffer<B, NearPair> near_;
  SearchCounts found_;
  SearchCounts room_{256, 1024, 256, 1024, 0};
  /// Blocks that a test goes through: on a processor all, down their tree.
  Index run_ = kSplits ? 1 : kAllBlocks;
};

}  // namespace scree::affine
