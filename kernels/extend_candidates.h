#pragma once
// Element programs that extend the list of near pairs: bodies that left their balls get new ones,
// and the pairs that these bring are put between those of the list. They are few among very many.

#include <cstdint>

#include "kernels/contact_key.h"
#include "kernels/pair_candidates.h"

namespace scree {

/// Gives a body that left its ball a new one. A body that has none any more has to leave the list,
/// which then counts as too much to add. Bytes per such body: 60 read, 32 written.
template <class Real>
struct RenewReach {
  static constexpr const char* name = "renew_reach";
  BodyBalls<Real> balls;
  BinnedRange binned;
  Vec3<double> origin;
  Span<const Index> left;
  Span<ReachRecord> record;     ///< [binned.size()] in, out
  Span<ReachRecord> left_ball;  ///< [left.size] out: the same, with room for rounding

  Index* pair_count;  ///< see FindMissingPairs

  static constexpr Index kTooMany = 1 << 20;

  SCREE_HD void operator()(Index k) const {
    const Index i = binned.body(left[k]);
    ReachRecord ball;
    ball.reach = balls.radius(i);
    if (ball.reach > 0) {
      ball.center = Vec3<float>(balls.center(i) - origin);
    } else {
      atomic_add(pair_count, kTooMany);
    }
    record[left[k]] = ball;
    left_ball[k] = room_for_rounding(ball);
  }
};

/// Finds the pairs of bodies that left their balls with all others which are not in the list yet.
/// All that left are compared with each group of binned bodies, which are near each other because
/// storage follows the Morton order, and only where they reach it with its bodies.
/// Bytes per binned body: 16 read.
struct FindMissingPairs {
  static constexpr const char* name = "find_missing_pairs";
  static constexpr Index kGroup = 16;
  BinnedRange binned;
  CandidateView list;
  Vec3<float> period;  ///< [m]; zero: not periodic
  Span<const ReachRecord> record;
  Span<const Index> left;
  Span<const ReachRecord> left_ball;
  Index* pair_count;  ///< in: zero; out: how many there are, also when there is not room for all
  Span<std::uint64_t> pair;  ///< out: keys of both bodies, the lower one first, in any order

  SCREE_HD Index group_count() const { return (binned.size() + kGroup - 1) / kGroup; }

  SCREE_HD void operator()(Index g) const {
    const Index first = g * kGroup;
    const Index end = binned.size() - first < kGroup ? binned.size() : first + kGroup;
    const ReachRecord group = ball_around(first, end);
    for (Index k = 0; k < left.size; ++k) {
      const ReachRecord other = left_ball[k];
      if (!overlap(group, other)) continue;
      for (Index m = first; m < end; ++m) {
        if (overlap(room_for_rounding(record[m]), other)) found(m, left[k]);
      }
    }
  }

 private:
  /// A ball that covers those of bodies [first, end), with room for its own rounding. Those that
  /// are apart by a period make it large, not wrong.
  SCREE_HD ReachRecord ball_around(Index first, Index end) const {
    Vec3<float> low(INFINITY, INFINITY, INFINITY), high = -low;
    for (Index m = first; m < end; ++m) {
      const ReachRecord ball = record[m];
      if (!(ball.reach > 0)) continue;
      for (int k = 0; k < 3; ++k) {
        low[k] = low[k] < ball.center[k] ? low[k] : ball.center[k];
        high[k] = high[k] > ball.center[k] ? high[k] : ball.center[k];
      }
    }
    ReachRecord group;
    if (!(low.x <= high.x)) return group;
    group.center = 0.5f * (low + high);
    for (Index m = first; m < end; ++m) {
      const ReachRecord ball = room_for_rounding(record[m]);
      if (!(ball.reach > 0)) continue;
      const float reach = norm(ball.center - group.center) + ball.reach;
      group.reach = group.reach > reach ? group.reach : reach;
    }
    group.reach *= 1.00001f;
    return room_for_rounding(group);
  }
  SCREE_HD bool overlap(const ReachRecord& x, const ReachRecord& y) const {
    const float sum = x.reach + y.reach;
    return norm2(nearest_image(y.center - x.center)) <= sum * sum * 1.00001f && x.reach > 0 &&
           y.reach > 0;
  }
  SCREE_HD Vec3<float> nearest_image(Vec3<float> d) const {
    for (int k = 0; k < 3; ++k) {
      if (period[k] > 0) d[k] -= period[k] * std::rint(d[k] / period[k]);
    }
    return d;
  }
  SCREE_HD bool has_left(Index m) const {
    for (Index k = 0; k < left.size; ++k) {
      if (left[k] == m) return true;
    }
    return false;
  }
  SCREE_HD void found(Index m, Index other) const {
    const Index i = binned.body(m), j = binned.body(other);
    const Index a = i < j ? i : j, b = i < j ? j : i;
    if (a == b || a >= binned.free_count) return;
    if (list.contains(a, b)) return;
    if (m > other && has_left(m)) return;  // two that left find each other twice
    const Index at = atomic_add(pair_count, 1);
    if (at < pair.size) pair[at] = make_key(a, static_cast<std::uint32_t>(b));
  }
};

/// Puts a pair between those of the list. Bytes per pair: 8 read, 8 written, and some cached reads
/// to find its place.
struct InsertAdded {
  static constexpr const char* name = "insert_added";
  CandidateView list;
  Span<const std::uint64_t> added;  ///< keys of the pairs, ascending; none is in the list
  Span<Index> place;                ///< [added.size] out: the candidate before which it goes
  Span<Index> other;                ///< [list.other.size + added.size] out
  SCREE_HD void operator()(Index e) const {
    const auto b = static_cast<Index>(key_element(added[e]));
    place[e] = list.place(key_body(added[e]), b);
    other[place[e] + e] = b;
  }
};

/// Moves a candidate up by the pairs that go before it.
/// Bytes per candidate: 4 read, 4 written, and the places from the caches.
struct MoveListed {
  static constexpr const char* name = "move_listed";
  Span<const Index> listed;
  Span<const Index> place;  ///< by InsertAdded
  Span<Index> other;        ///< out
  SCREE_HD void operator()(Index k) const {
    const auto count = static_cast<Index>(place.size);
    other[k + first_not_below(place, 0, count, k + 1)] = listed[k];
  }
};

/// Where the candidates of each body begin after pairs were added, for CutPieces.
/// Bytes per piece: 12 read, per body 8 written, and the added pairs from the caches.
struct BeginExtended {
  static constexpr const char* name = "begin_extended";
  CandidateView list;
  Span<const std::uint64_t> added;  ///< keys, ascending
  Span<Offset> begin;               ///< [free_count + 1] out
  SCREE_HD void operator()(Index p) const {
    const Index a = list.body[p], more = static_cast<Index>(added.size);
    if (p == 0 || list.body[p - 1] != a)
      begin[a] = list.begin[p] + first_not_below(added, 0, more, make_key(a, 0));
    if (p + 1 == list.piece_count()) begin[a + 1] = list.begin[p + 1] + more;
  }
};

}  // namespace scree
