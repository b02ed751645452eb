#pragma once
// The list of pairs of bodies that may touch, kept over several steps.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "collision/broad_phase.h"
#include "collision/numbering.h"
#include "kernels/broad_phase/extend_candidates.h"

namespace scree {

/// Memory: 16 bytes a binned body, 8 an owned body and 4.25 a pair; 1 more a body once the list was
/// extended. While it is: 9 bytes a body and 4 a pair, 8 with notes.
template <class B, class Real>
class PairCandidates {
 public:
  explicit PairCandidates(B& b)
      : record_(b),
        body_(b),
        begin_(b),
        other_(b),
        group_(b),
        block_(b),
        left_(b),
        left_count_(b, 1),
        left_result_(b, 1) {
    fill(b, left_count_.view(), Index(0));
  }

  /// Whether the list holds every pair that may touch within the range. It does not after
  /// forget() and retire(), when there are other bodies than before, or when one left its ball; else nothing
  /// but where bodies are now counts, so any range may come. One host read.
  /// Bytes per binned body: 60.
  bool covers(B& b, const BodyView<Real>& bodies, const ContactRange& range) {
    const BodyRanges& binned = bodies.ranges();
    if (is_kept_ && is_retired_) {
      has_passes_ = true;
      return false;
    }
    if (!is_kept_ || binned != binned_) {
      forget();
      has_passes_ = true;
      return false;
    }
    reduce<LeftBodies>(b, binned.present_count(),
                       CheckReach<Real>{{bodies, range, {}},
                                        binned,
                                        origin_,
                                        record_.view(binned.present_count()),
                                        left_count_.data(),
                                        left_.view()},
                       StoreLeft{left_result_.data(), left_count_.data()});
    const LeftBodies left = fetch(b, left_result_.data());
    outside_ = left.count;
    leaving_ = left.leaving;
    has_passes_ = left.passing != 0;
    ++age_;
    return outside_ == 0;
  }

  /// Makes the list cover the range, after covers() said that it does not: adds what a few bodies
  /// that left their balls may touch now, or rebuilds the list. An old list is not extended:
  /// more and more bodies leave their balls, and extensions in every listing are dearer than a new
  /// list now and then.
  /// @param note  [candidates] what is noted of each, or empty; follows the list: kNotNoted at
  ///              pairs that were added, empty when the list is a new one
  void renew(B& b, const BodyView<Real>& bodies, const ContactRange& range, SpareReach spare,
             Buffer<B, float>& note) {
    spare.skin *= stretch_;
    const bool extends = is_kept_ && !is_retired_ && is_young() && outside_ <= left_.capacity();
    if (extends && extend(b, bodies, range, for_few(spare), note)) return;
    note.release();
    if (is_kept_) stretch(spare);
    build(b, bodies, range, spare);
  }

  /// Makes the list for the range and some way beyond; three host reads, one of them by the bins.
  /// Bytes per body besides the bins, m candidates each, every array counted once: 60 for the
  /// balls, 44 + 12 m to search, 48 + 28 m to put into order (m is about 5 in a dense bed).
  /// @param spare  without skin the list serves only one listing
  /// @throws std::runtime_error when there are more pairs than an Index can number
  void build(B& b, const BodyView<Real>& bodies, const ContactRange& range,
             const SpareReach& spare) {
    release();
    const Index n = bodies.owned_count;
    const BodyBalls<Real> balls{bodies, range, spare};
    const Bins<B> bins = sort_into_bins(b, balls);
    binned_ = bodies.ranges();
    origin_ = bins.view.lower;
    for_each(b, binned_.present_count(),
             RecordReach<Real>{balls, binned_, origin_, bins.view.inflated,
                               record_.resize_discard(binned_.present_count())});

    const PairSearch<Real> search{balls, n, bins.view};
    const Index elements = search.size();
    Buffer<B, Index> slot(b, static_cast<Offset>(elements) * kPairSlots);
    const Index chunks = chunks_for(bins.view.slice_count);
    Buffer<B, Index> chunk(b, static_cast<Offset>(chunks) * kPairSlots), chunk_body(b, chunks);
    Buffer<B, Index> chunk_count(b, 1), counters(b, n + 1);
    const Span<Index> count = counters.view(n);
    Buffer<B, Offset> first(b, static_cast<Offset>(n) + 1);
    fill(b, counters.view(), Index(0));
    fill(b, chunk_count.view(), Index(0));
    const FoundPairs found{elements, slot.view(), chunk_count.data(), chunk_body.view(),
                           chunk.view()};
    for_each(b, elements, CountCandidates<Real>{search, count, found});
    exclusive_scan(b, Span<const Index>(count), first.view());
    const Offset total = fetch(b, first.data() + n);
    checked_index(total, can_number(n, total), "pairs of near bodies");
    Buffer<B, Index> lower(b, total), other(b, total);
    const PairPlaces places{first.view(), count, lower.view(), other.view()};
    for_each(b, elements, WriteCandidates<Real>{search, found, places});
    for_each(b, chunks, WriteChunks{found, places});
    slot.release(), chunk.release(), chunk_body.release();
    put_into_order(b, n, places, counters.data() + n);
    left_.resize_discard(most_renewed(binned_.present_count()));
    is_kept_ = spare.skin > 0;
    is_retired_ = false;
    leaving_ = 0;
    age_ = extensions_ = 0;
    ++build_count_;
  }

  CandidateView view() const {
    return {body_.view(body_.capacity()), begin_.view(begin_.capacity()),
            other_.view(other_.capacity())};
  }

  /// The next listing needs a new list: bodies changed places.
  void forget() { is_kept_ = false; }
  /// The same, and gives the memory back.
  void release() {
    forget();
    record_.release(), body_.release(), begin_.release(), other_.release(), left_.release();
    group_.release(), block_.release();
  }

  /// Whether a body is about to leave its ball, and the list too old to be extended, as far as the last covers() saw.
  bool is_spent() const { return is_kept_ && leaving_ > 0 && !is_young(); }
  /// The list serves no more.
  void retire() { is_retired_ = true; }

  /// Whether spheres may pass each other within the step, as far as the last covers() saw: it reads
  /// bodies only when there is a list.
  bool has_passes() const { return has_passes_; }

  /// Lists made so far, and how often one was extended.
  std::int64_t build_count() const { return build_count_; }
  std::int64_t extension_count() const { return extension_count_; }

 private:
  /// Most bodies that get new balls in a list: a share of all, since each is compared with the
  /// covers of all others, which should not take longer than a new list.
  static Index most_renewed(Index bodies) {
    constexpr Index kMinBodies = B::kIsDevice ? 1024 : 128, kMaxBodies = 8192, kShare = 128;
    const Offset blocks = CoverBalls::covers_of(CoverBalls::covers_of(bodies));
    const Offset numbered = std::numeric_limits<Index>::max() / std::max<Offset>(blocks, 1);
    return static_cast<Index>(
        std::min<Offset>(std::clamp(bodies / kShare, kMinBodies, kMaxBodies), numbered));
  }
  static Index most_added(Index renewed) { return std::min(64 * renewed, kMostAddedPairs); }
  /// A list that has served for so many listings is not extended any more, and for half a listing
  /// more for each time it was: what it costs for each listing has then come down to what
  /// extensions will cost.
  static constexpr Index kMostAge = 10;
  /// A list that lasts for fewer listings gets more skin the next time, one for more gets less.
  static constexpr Index kShortAge = 9, kLongAge = 20;
  /// Bodies that leave their balls move more than others, and do so again: as long as they are few, they may have room for the
  /// rest of the list's life.
  static SpareReach for_few(SpareReach spare) {
    spare.skin *= 2;
    spare.steps_ahead *= 3;
    return spare;
  }
  static constexpr double kStretchStep = 1.5, kMostStretch = 4;

  bool is_young() const { return age_ < kMostAge + extensions_ / 2; }

  /// Gives the bodies that left their balls new ones, and adds what they reach to the list;
  /// one host read. Bytes per body with m candidates: 3, the first time 19, and 36 + 8 m,
  /// with notes 36 + 16 m, when there is something to add.
  /// @return  false when there is too much to add: the list is void then
  bool extend(B& b, const BodyView<Real>& bodies, const ContactRange& range,
              const SpareReach& spare, Buffer<B, float>& note) {
    const Span<const Index> left = std::as_const(left_).view(outside_);
    const Span<const ReachRecord> record = std::as_const(record_).view(binned_.present_count());
    Buffer<B, ReachRecord> ball(b, outside_);
    Buffer<B, std::uint8_t> has_left(b, binned_.present_count());
    Buffer<B, Index> counter(b, 3);
    const Offset room = most_added(static_cast<Index>(left_.capacity()));
    Buffer<B, BallHit> block_hit(b, room), group_hit(b, room);
    Buffer<B, std::uint64_t> pair(b, room);
    fill(b, counter.view(), Index(0));
    fill(b, has_left.view(), std::uint8_t(0));
    Index* const pair_count = counter.data();
    for_each(b, outside_,
             RenewReach<Real>{{bodies, range, spare},
                              binned_,
                              origin_,
                              left,
                              record_.view(binned_.present_count()),
                              ball.view(),
                              has_left.view(),
                              pair_count});
    cover(b, record, has_left.view());
    const Span<const ReachRecord> group = std::as_const(group_).view(group_.capacity());
    const BallOverlap overlap{Vec3<float>(range.period)};
    const BallHits blocks{counter.data() + 1, block_hit.view()};
    const BallHits groups{counter.data() + 2, group_hit.view()};
    const HitBlocks hit_blocks{overlap, block_.view(), ball.view(), blocks};
    for_each(b, hit_blocks.size(), hit_blocks);
    for_each(b, kHitElements, HitGroups{overlap, group, ball.view(), blocks, groups});
    for_each(b, kHitElements,
             FindMissingPairs{overlap, binned_, view(), record, left, ball.view(), has_left.view(),
                              blocks, groups, pair_count, pair.view()});
    const Index more = fetch(b, pair_count);
    if (more > pair.capacity()) return false;
    ++extensions_, ++extension_count_;
    return more == 0 || insert(b, pair.view(more), note);
  }

  /// Covers the balls, all when the list is extended for the first time, then those that changed.
  void cover(B& b, Span<const ReachRecord> record, Span<const std::uint8_t> has_changed) {
    const Offset groups = CoverBalls::covers_of(record.size);
    if (group_.capacity() == 0) has_changed = {};
    for_each(b, static_cast<Index>(groups),
             CoverBalls{record, has_changed, group_.resize_discard(groups)});
    const Offset blocks = CoverBalls::covers_of(groups);
    for_each(b, static_cast<Index>(blocks),
             CoverBalls{std::as_const(group_).view(groups), {}, block_.resize_discard(blocks)});
  }

  /// Puts pairs that are not in the list into it.
  /// @return  false when the list would get too long: it is as before
  bool insert(B& b, Span<std::uint64_t> pair, Buffer<B, float>& note) {
    const Index n = binned_.owned_count, more = static_cast<Index>(pair.size);
    const CandidateView list = view();
    const auto listed = static_cast<Index>(list.other.size);
    if (!can_number(n, static_cast<Offset>(listed) + more)) return false;
    SortSpace<B> sort(b);
    Buffer<B, Index> place(b, more), other(b, listed + more);
    fill(b, place.view(), Index(0));  // the sort moves it along
    sort_pairs(b, sort, pair, place.view(), 32 + bits_for(static_cast<std::uint64_t>(n)));
    Buffer<B, Offset> begin(b, static_cast<Offset>(n) + 1);
    const Offset notes = note.capacity();
    Buffer<B, float> extended_note(b, notes > 0 ? other.capacity() : 0);
    const NotedCandidates<Index, float> extended{other.view(), extended_note.view()};
    for_each(b, more, InsertAdded{list, pair, place.view(), extended});
    const MoveListed move{
        {list.other, std::as_const(note).view(notes)}, std::as_const(place).view(more), extended};
    for_each(b, move.size(), move);
    for_each(b, list.piece_count(), BeginExtended{list, pair, begin.view()});
    cut(b, n, begin.view(), other.capacity());
    swap(other_, other);
    swap(note, extended_note);
    return true;
  }

  /// Fits the skin to how long the list lasted. Never below what was asked for: shorter lists would
  /// call for still shorter ones.
  void stretch(SpareReach& spare) {
    const double skin = spare.skin / stretch_;
    if (age_ < kShortAge && !is_retired_)
      stretch_ = std::min(kMostStretch, kStretchStep * stretch_);
    if (age_ > kLongAge) stretch_ = std::max(1.0, stretch_ / kStretchStep);
    spare.skin = skin * stretch_;
  }

  /// Elements that find more than their slots hold are large bodies, which search in slices.
  static Index chunks_for(Index slices) { return slices / 16 + 64; }

  /// The list, from pairs that are together for each lower body; one host read.
  /// @param long_elements  see order_lists()
  void put_into_order(B& b, Index owned_count, const PairPlaces& pairs, Index* long_elements) {
    const Offset total = pairs.lower.size;
    cut(b, owned_count, pairs.begin, total);
    const UnorderedLists<LowerBodyOf> lists{{pairs.lower}, pairs.other, pairs.begin};
    order_lists(b, static_cast<Index>(total), lists, other_.resize_discard(total), long_elements);
  }

  /// Makes the pieces. @param begin  [owned_count + 1] where the candidates of each body begin
  void cut(B& b, Index owned_count, Span<const Offset> begin, Offset total) {
    const Offset pieces = first_piece(owned_count, total);
    for_each(b, owned_count + 1,
             CutPieces{owned_count, begin, body_.resize_discard(pieces),
                       begin_.resize_discard(pieces + 1)});
  }

  Buffer<B, ReachRecord> record_;
  Buffer<B, Index> body_;
  Buffer<B, Index> begin_;
  Buffer<B, Index> other_;
  Buffer<B, ReachRecord> group_, block_;  ///< covers of balls; empty until the list is extended
  Buffer<B, Index> left_;
  Buffer<B, Index> left_count_;
  Buffer<B, LeftBodies> left_result_;
  BodyRanges binned_;
  Vec3<double> origin_;
  bool is_kept_ = false;
  bool is_retired_ = false;  ///< since it was made
  bool has_passes_ = true;
  double stretch_ = 1;    ///< of the skin
  Index outside_ = 0;     ///< bodies outside their balls, by the last covers()
  Index leaving_ = 0;     ///< and those that will be outside after one more step
  Index age_ = 0;         ///< listings since the list was made
  Index extensions_ = 0;  ///< since then
  std::int64_t build_count_ = 0;
  std::int64_t extension_count_ = 0;
};

}  // namespace scree
