#pragma once
// Element programs that extend the list of near pairs: bodies that left their balls get new ones,
// and the pairs that these bring are put between those of the list. They are few among very many.

#include <cstdint>

#include "kernels/broad_phase/pair_candidates.h"
#include "kernels/math/pair_key.h"

namespace scree {

/// Most pairs that are added to a list at a time.
inline constexpr Index kMostAddedPairs = 1 << 17;
/// Added to the number of missing pairs when they cannot be added, which may happen at
/// each body that left.
inline constexpr Index kTooManyPairs = kMostAddedPairs + 1;

/// So many balls that follow each other are covered by one.
inline constexpr Index kCovered = 16;

/// Covers balls that are near each other, because storage follows the Morton order, by a larger
/// one. Bytes per ball: 16 read; 16 written for each that covers. Of balls that did not change: 1.
struct CoverBalls {
  static constexpr const char* name = "cover_balls";
  Span<const ReachRecord> ball;
  Span<const std::uint8_t> has_changed;  ///< [ball.size]; empty: all have
  Span<ReachRecord> cover;               ///< [covers_of(ball.size)] in, out, with room for rounding

  SCREE_HD static Offset covers_of(Offset balls) { return (balls + kCovered - 1) / kCovered; }

  /// Balls that are apart by a period make the cover large, not wrong.
  SCREE_HD void operator()(Index g) const {
    const Index first = g * kCovered;
    const Index end =
        first + kCovered < ball.size ? first + kCovered : static_cast<Index>(ball.size);
    if (!has_any_changed(first, end)) return;
    Vec3<float> low(INFINITY, INFINITY, INFINITY), high = -low;
    for (Index m = first; m < end; ++m) {
      if (!(ball[m].reach > 0)) continue;
      const Vec3<float> x = ball[m].center;
      for (int k = 0; k < 3; ++k) {
        low[k] = low[k] < x[k] ? low[k] : x[k];
        high[k] = high[k] > x[k] ? high[k] : x[k];
      }
    }
    ReachRecord all;
    if (low.x <= high.x) all.center = 0.5f * (low + high);
    for (Index m = first; m < end; ++m) {
      const ReachRecord own = room_for_rounding(ball[m]);
      if (!(own.reach > 0)) continue;
      const float reach = norm(own.center - all.center) + own.reach;
      all.reach = all.reach > reach ? all.reach : reach;
    }
    all.reach *= 1.00001f;
    cover[g] = room_for_rounding(all);
  }

 private:
  SCREE_HD bool has_any_changed(Index first, Index end) const {
    if (has_changed.empty()) return true;
    unsigned any = 0;
    for (Index m = first; m < end; ++m) any |= has_changed[m];
    return any != 0;
  }
};

/// Gives a body that left its ball a new one. A body that has none any more has to leave the list,
/// which then counts as too much to add. Bytes per such body: 60 read, 36 written.
template <class Real>
struct RenewReach {
  static constexpr const char* name = "renew_reach";
  BodyBalls<Real> balls;
  BodyRanges binned;
  Vec3<double> origin;
  Span<const Index> left;
  Span<ReachRecord> record;     ///< [binned.present_count()] in, out
  Span<ReachRecord> left_ball;  ///< [left.size] out: the same, with room for rounding
  /// [binned.present_count()] in: zero; out: one for bodies that left
  Span<std::uint8_t> has_left;
  Index* pair_count;  ///< see FindMissingPairs

  SCREE_HD void operator()(Index k) const {
    const Index i = binned.present(left[k]);
    ReachRecord ball;
    ball.reach = balls.radius(i);
    if (ball.reach > 0) {
      ball.center = Vec3<float>(balls.center(i) - origin);
    } else {
      atomic_add(pair_count, kTooManyPairs);
    }
    record[left[k]] = ball;
    left_ball[k] = room_for_rounding(ball);
    has_left[left[k]] = 1;
  }
};

/// A ball that one of a body that left overlaps.
struct BallHit {
  Index ball = 0;
  Index left = 0;  ///< its number among bodies that left
};

/// Hits, in any order. There may be more than room for them: they are counted all the same.
struct BallHits {
  Index* count;  ///< in: zero
  Span<BallHit> hit;

  SCREE_HD bool has_all() const { return *count <= hit.size; }
  SCREE_HD Index size() const { return has_all() ? *count : static_cast<Index>(hit.size); }
  SCREE_HD void add(const BallHit& h) const {
    const Index at = atomic_add(count, 1);
    if (at < hit.size) hit[at] = h;
  }
};

/// Whether balls overlap, the nearest image of one at least.
struct BallOverlap {
  Vec3<float> period;  ///< [m]; zero: not periodic

  SCREE_HD bool operator()(const ReachRecord& x, const ReachRecord& y) const {
    const float sum = x.reach + y.reach;
    return norm2(nearest_image(y.center - x.center)) <= sum * sum * 1.00001f && x.reach > 0 &&
           y.reach > 0;
  }

 private:
  SCREE_HD Vec3<float> nearest_image(Vec3<float> d) const {
    for (int k = 0; k < 3; ++k) {
      if (period[k] > 0) d[k] -= period[k] * std::rint(d[k] / period[k]);
    }
    return d;
  }
};

/// Finds the largest covers that bodies which left reach: one element for each of both.
/// Bytes per element: 32, from the caches.
struct HitBlocks {
  static constexpr const char* name = "hit_blocks";
  BallOverlap overlap;
  Span<const ReachRecord> block;
  Span<const ReachRecord> left_ball;
  BallHits hits;  ///< out

  SCREE_HD Index size() const { return static_cast<Index>(block.size * left_ball.size); }
  SCREE_HD void operator()(Index e) const {
    const auto blocks = static_cast<Index>(block.size);
    const BallHit h{e % blocks, e / blocks};
    if (overlap(block[h.ball], left_ball[h.left])) hits.add(h);
  }
};

/// How many elements search what is below the covers that were hit: their number is not known to
/// the host, so each takes one after the other.
inline constexpr Index kHitElements = 1 << 17;

/// Calls f(hit) for what is below the hits of larger covers, as one of kHitElements elements.
template <class F>
SCREE_HD void below_hits(const BallHits& larger, Offset balls, Index element, F&& f) {
  const Offset count = static_cast<Offset>(larger.size()) * kCovered;
  for (Offset q = element; q < count; q += kHitElements) {
    const BallHit h = larger.hit[q / kCovered];
    const Offset ball = static_cast<Offset>(h.ball) * kCovered + q % kCovered;
    if (ball < balls) f(BallHit{static_cast<Index>(ball), h.left});
  }
}

/// The same for the covers below those that were hit. Bytes per such cover: 8, 32 from the caches.
struct HitGroups {
  static constexpr const char* name = "hit_groups";
  BallOverlap overlap;
  Span<const ReachRecord> group;
  Span<const ReachRecord> left_ball;
  BallHits larger;
  BallHits hits;  ///< out

  SCREE_HD void operator()(Index e) const {
    below_hits(larger, group.size, e, [&](const BallHit& h) {
      if (overlap(group[h.ball], left_ball[h.left])) hits.add(h);
    });
  }
};

/// Finds the pairs of bodies that left their balls with all others which are not in the list yet,
/// below the covers that were hit. When there was no room for all hits, that counts as too much to
/// add. Bytes per body below: 8, 32 from the caches.
struct FindMissingPairs {
  static constexpr const char* name = "find_missing_pairs";
  BallOverlap overlap;
  BodyRanges binned;
  CandidateView list;
  Span<const ReachRecord> record;
  Span<const Index> left;
  Span<const ReachRecord> left_ball;
  Span<const std::uint8_t> has_left;  ///< [binned.present_count()] by RenewReach
  BallHits blocks, groups;
  Index* pair_count;  ///< in: zero; out: how many there are, also when there is not room for all
  Span<std::uint64_t> pair;  ///< out: keys of both bodies, the lower one first, in any order

  SCREE_HD void operator()(Index e) const {
    if (e == 0 && !(blocks.has_all() && groups.has_all())) atomic_add(pair_count, kTooManyPairs);
    below_hits(groups, record.size, e, [&](const BallHit& h) {
      if (overlap(room_for_rounding(record[h.ball]), left_ball[h.left]))
        found(h.ball, left[h.left]);
    });
  }

 private:
  SCREE_HD void found(Index m, Index other) const {
    const Index i = binned.present(m), j = binned.present(other);
    const Index a = i < j ? i : j, b = i < j ? j : i;
    if (a == b || !binned.is_owned(a)) return;
    if (m > other && has_left[m] != 0) return;  // two that left find each other twice
    if (list.contains(a, b)) return;
    const Index at = atomic_add(pair_count, 1);
    if (at < pair.size) pair[at] = make_key(a, static_cast<std::uint32_t>(b));
  }
};

/// Candidates, and what else is known of each.
template <class I, class T>
struct NotedCandidates {
  Span<I> other;
  Span<T> note;  ///< as many, or empty: nothing is
};

/// Puts a pair between those of the list; nothing is known of it. Bytes per pair: 8 read, 8
/// written, 4 more for its note, and some cached reads to find its place.
struct InsertAdded {
  static constexpr const char* name = "insert_added";
  CandidateView list;
  Span<const std::uint64_t> added;         ///< keys of the pairs, ascending; none is in the list
  Span<Index> place;                       ///< [added.size] out: the candidate before which it goes
  NotedCandidates<Index, float> extended;  ///< [list.other.size + added.size] out
  SCREE_HD void operator()(Index e) const {
    const auto b = static_cast<Index>(key_element(added[e]));
    place[e] = list.place(key_body(added[e]), b);
    extended.other[place[e] + e] = b;
    if (!extended.note.empty()) extended.note[place[e] + e] = kNotNoted;
  }
};

/// Moves candidates up by the pairs that go before them. An element moves several, at distances
/// that let elements beside each other move neighbors, and searches for the places once.
/// Bytes per candidate: 4 read, 4 written, 8 more for its note, and the places from the caches.
struct MoveListed {
  static constexpr const char* name = "move_listed";
  static constexpr Index kEach = 4, kApart = 32;
  NotedCandidates<const Index, const float> listed;
  Span<const Index> place;                 ///< by InsertAdded
  NotedCandidates<Index, float> extended;  ///< out

  SCREE_HD Index size() const {
    const auto count = static_cast<Index>(listed.other.size);
    return (count + kEach * kApart - 1) / (kEach * kApart) * kApart;
  }
  SCREE_HD void operator()(Index e) const {
    const auto count = static_cast<Index>(place.size);
    const Index first = e / kApart * kApart * kEach + e % kApart;
    Index before = first_not_below(place, 0, count, first + 1);
    for (Index n = 0; n < kEach; ++n) {
      const Index k = first + n * kApart;
      if (k >= listed.other.size) return;
      while (before < count && place[before] <= k) ++before;
      extended.other[k + before] = listed.other[k];
      if (!listed.note.empty()) extended.note[k + before] = listed.note[k];
    }
  }
};

/// Where the candidates of each body begin after pairs were added, for CutPieces.
/// Bytes per piece: 12 read, per body 8 written, and the added pairs from the caches.
struct BeginExtended {
  static constexpr const char* name = "begin_extended";
  CandidateView list;
  Span<const std::uint64_t> added;  ///< keys, ascending
  Span<Offset> begin;               ///< [owned_count + 1] out
  SCREE_HD void operator()(Index p) const {
    const Index a = list.body[p], more = static_cast<Index>(added.size);
    if (p == 0 || list.body[p - 1] != a)
      begin[a] = list.begin[p] + first_not_below(added, 0, more, make_key(a, 0));
    if (p + 1 == list.piece_count()) begin[a + 1] = list.begin[p + 1] + more;
  }
};

}  // namespace scree
