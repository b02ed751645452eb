#pragma once
// Element programs of the list of pairs of bodies that may touch: whether it still covers a step,
// and how it is made.
//
// When the list is made, every binned body gets a ball, of the present step and some room more, and
// all pairs whose balls overlap are listed. As long as the ball of every body in the present step
// stays within that, no contact between bodies lies outside the list.

#include "kernels/backend/ordered_lists.h"
#include "kernels/broad_phase/pair_search.h"

namespace scree {

/// Candidates of one piece at most: as many as an Index has bits for, see CountContacts.
inline constexpr Index kPieceLength = 32;

/// Pairs sorted by (body a, other body), a being the owned body with the lower storage index. They
/// are cut into pieces, so that one large body among many small ones does not hold up all others:
/// where a body's candidates begin, and at each multiple of kPieceLength. Every owned body has at
/// least one piece.
struct CandidateView {
  Span<const Index> body;   ///< [piece count] body a
  Span<const Index> begin;  ///< [piece count + 1] its first candidate
  Span<const Index> other;  ///< [begin[piece count]] ascending within a body

  SCREE_HD Index piece_count() const { return static_cast<Index>(body.size); }
  SCREE_HD bool is_last_of_body(Index p) const {
    return p + 1 == body.size || body[p + 1] != body[p];
  }
  SCREE_HD Index last_piece(Index a) const {
    return first_not_below(body, 0, piece_count(), a + 1) - 1;
  }
  /// Whether the pair is in the list; a < b.
  SCREE_HD bool contains(Index a, Index b) const {
    const Index k = place(a, b);
    return k < first_of(a + 1) && other[k] == b;
  }
  /// Candidate before which the pair is in ascending order, or the pair itself; a < b.
  SCREE_HD Index place(Index a, Index b) const {
    return first_not_below(other, first_of(a), first_of(a + 1), b);
  }

 private:
  /// First candidate of a body, or of those after it.
  SCREE_HD Index first_of(Index a) const {
    return begin[first_not_below(body, 0, piece_count(), a)];
  }
};

/// Stands in a list of notes on candidates where there is none yet.
inline constexpr float kNotNoted = NAN;

/// First piece of a body whose candidates begin at `begin`.
SCREE_HD inline Offset first_piece(Index a, Offset begin) { return a + begin / kPieceLength; }

/// The ball of a body: 16 bytes.
struct alignas(16) ReachRecord {
  Vec3<float> center;  ///< relative to the origin of the list [m]
  float reach = 0;     ///< radius [m]; 0: the body has no pairs

  /// Twice what rounding the center to float may have moved it [m].
  SCREE_HD double rounding() const {
    const Vec3<double> x(center);
    return 1.2e-7 * (std::abs(x.x) + std::abs(x.y) + std::abs(x.z));
  }
};

/// A ball so much larger that two of them overlap wherever those before rounding do,
/// images included.
SCREE_HD inline ReachRecord room_for_rounding(const ReachRecord& ball) {
  if (!(ball.reach > 0)) return ball;
  return {ball.center, ball.reach + static_cast<float>(4 * ball.rounding())};
}

/// Bytes per binned body: 44 read, 16 written.
template <class Real>
struct RecordReach {
  static constexpr const char* name = "record_reach";
  BodyBalls<Real> balls;
  BodyRanges binned;
  Vec3<double> origin;
  Span<const float> reach;   ///< [binned.present_count()]
  Span<ReachRecord> record;  ///< [binned.present_count()] out

  SCREE_HD void operator()(Index m) const {
    record[m] = {Vec3<float>(balls.center(binned.present(m)) - origin), reach[m]};
  }
};

/// Bodies that left their balls, and fast ones: the record of a reduction.
struct LeftBodies {
  Index count = 0;
  Index leaving = 0;  ///< the same after one more such step
  Index passing = 0;  ///< bodies that may pass another within the step, see CheckReach::passes()
  SCREE_HD void combine(const LeftBodies& o) {
    count += o.count;
    leaving += o.leaving;
    passing += o.passing;
  }
};

/// Whether a body, as far as it may touch others in the step, is within its ball; notes those that
/// are not, in any order, as many as there is room for. A body that got a state which is not
/// finite, or lost it, counts as outside.
/// Bytes per binned body: 60 read, with margins 64.
template <class Real>
struct CheckReach {
  static constexpr const char* name = "check_reach";
  BodyBalls<Real> balls;  ///< of the present step
  BodyRanges binned;
  Vec3<double> origin;
  Span<const ReachRecord> record;  ///< [binned.present_count()]
  Index* left_count;               ///< in: zero; out: bodies noted, or more
  Span<Index> left;                ///< out: number of each among binned bodies

  SCREE_HD LeftBodies operator()(Index m) const {
    const Index i = binned.present(m);
    const double way = balls.range.h * norm(course_velocity(balls.bodies, balls.range, i));
    const Index passing = passes(i, way) ? 1 : 0;
    const double room = room_in_ball(m);
    if (room >= way) return {0, 0, passing};
    if (room >= 0) return {0, 1, passing};
    if (atomic_read(left_count) >= left.size) return {1, 1, passing};
    const Index at = atomic_add(left_count, 1);
    if (at < left.size) left[at] = m;
    return {1, 1, passing};
  }
  /// False for two spheres only when spheres_on_way() leaves their contact as it is.
  /// @param way  of the body in the step [m]
  SCREE_HD bool passes(Index i, double way) const {
    const double own = balls.bodies.radius[i];
    return !(way <= (1 - 1e-6) * kMinTurningWay * own);
  }
  /// How much farther the body may go [m]; below zero: it left.
  SCREE_HD double room_in_ball(Index m) const {
    const Index i = binned.present(m);
    const float inflated = balls.radius(i);
    const ReachRecord own = record[m];
    if (!(inflated > 0) || !(own.reach > 0)) return !(inflated > 0) && !(own.reach > 0) ? 1e30 : -1;
    const Vec3<double> center(own.center);
    const double moved = norm(minimum_image(balls.center(i) - origin - center, balls.range.period));
    const double room =
        static_cast<double>(own.reach) - (moved + own.rounding() + static_cast<double>(inflated));
    return room >= 0 ? room : -1;  // also where it is not a number
  }
};

/// Stores how many bodies left, and makes their counter ready for the next check.
struct StoreLeft {
  LeftBodies* result;
  Index* left_count;
  SCREE_HD void operator()(const LeftBodies& total) const {
    *result = total;
    *left_count = 0;
  }
};

/// Bodies found by an element of the search are noted in this many slots; for those beyond it takes
/// chunks of as many out of a store for all.
inline constexpr Index kPairSlots = 16;
/// They are read in groups, so that a thread does not wait for one pair after the other.
inline constexpr Index kSlotGroup = 4;
/// Stands behind the last one found, to the end of its group; a group that follows a full one
/// begins with it when there are no more.
inline constexpr Index kNoMore = -1;

/// What the elements of the search found.
struct FoundPairs {
  Index stride = 0;        ///< number of elements
  Span<Index> slot;        ///< [kPairSlots * stride] slot by slot
  Index* chunk_count;      ///< chunks that were asked for
  Span<Index> chunk_body;  ///< [chunks there are] whose element took it
  Span<Index> chunk;       ///< [kPairSlots * chunks] chunk by chunk

  SCREE_HD Index chunks() const { return static_cast<Index>(chunk_body.size); }
  /// When not, elements with more than their slots hold are searched again, and no chunk counts.
  SCREE_HD bool had_chunks_enough() const { return *chunk_count <= chunks(); }
  SCREE_HD Index& own(Index element, Index n) const {
    return slot[static_cast<Offset>(n) * stride + element];
  }
  SCREE_HD Index& in_chunk(Index c, Index n) const {
    return chunk[static_cast<Offset>(c) * kPairSlots + n];
  }
};

/// Counts the pairs of each lower body, and notes what each element of the search finds.
/// Bytes per element, besides neighbors from the caches: 28 read, 8 per pair and 4 written;
/// 4 per pair added to.
template <class Real>
struct CountCandidates {
  static constexpr const char* name = "count_candidates";
  static constexpr int kLeastBlocks = 4;
  PairSearch<Real> search;
  Span<Index> count;  ///< [owned_count] in: zero; out: pairs whose lower body it is
  FoundPairs found;   ///< out; in: chunk_count is zero

  SCREE_HD void operator()(Index e) const {
    const Index i = search.body(e);
    Index n = 0, chunk = 0;  // n: in the slots, or in the chunk
    bool is_in_chunk = false;
    const auto note = [&](Index j) {
      if (!is_in_chunk) {
        found.own(e, n) = j;
      } else if (chunk < found.chunks()) {
        found.in_chunk(chunk, n) = j;
      }
    };
    search(e, [&](Index j) {
      if (n == kPairSlots) {
        chunk = atomic_add(found.chunk_count, 1);
        if (chunk < found.chunks()) found.chunk_body[chunk] = i;
        is_in_chunk = true;
        n = 0;
      }
      note(j);
      ++n;
      atomic_add(&count[i < j ? i : j], 1);
    });
    if (n == kPairSlots) return;
    do {
      note(kNoMore);
      ++n;
    } while (n % kSlotGroup != 0);
  }
};

/// Puts pairs among those of their lower body, in any order.
struct PairPlaces {
  Span<const Offset> begin;  ///< [owned_count + 1] scan of count
  Span<Index> count;         ///< [owned_count] pairs still to come
  Span<Index> lower;         ///< out: the lower body
  Span<Index> other;         ///< out: the higher body

  SCREE_HD Offset take(Index i, Index j) const {
    const Index a = i < j ? i : j;
    return begin[a] + atomic_add(&count[a], -1) - 1;
  }
  SCREE_HD void put(Offset at, Index i, Index j) const {
    lower[at] = i < j ? i : j;
    other[at] = i < j ? j : i;
  }
  SCREE_HD void put(Index i, Index j) const { put(take(i, j), i, j); }

  /// Puts the pairs of body i with those in the slots. @param slot  slot(n): the n-th one
  /// @return  whether all slots hold one
  template <class Slot>
  SCREE_HD bool put_slots(Index i, Slot&& slot) const {
    for (Index n = 0; n < kPairSlots; n += kSlotGroup) {
      Index j[kSlotGroup];
      Offset at[kSlotGroup] = {};  // GCC 13 does not see that what is read was written
      for (Index k = 0; k < kSlotGroup; ++k) j[k] = slot(n + k);
      for (Index k = 0; k < kSlotGroup; ++k) {
        if (j[k] != kNoMore) at[k] = take(i, j[k]);
      }
      for (Index k = 0; k < kSlotGroup; ++k) {
        if (j[k] == kNoMore) return false;
        put(at[k], i, j[k]);
      }
    }
    return true;
  }
};

/// Puts the pairs that were counted into their places: those of the slots.
/// Bytes per pair: 4 read, 8 written; 4 of the counts added to, and 8 of the scan, from the caches.
template <class Real>
struct WriteCandidates {
  static constexpr const char* name = "write_candidates";
  PairSearch<Real> search;
  FoundPairs found;
  PairPlaces places;

  SCREE_HD void operator()(Index e) const {
    if (found.own(e, 0) == kNoMore) return;
    const Index i = search.body(e);
    const bool is_full = places.put_slots(i, [&](Index n) { return found.own(e, n); });
    if (!is_full || found.had_chunks_enough()) return;
    Index n = 0;
    search(e, [&](Index j) {
      if (n++ >= kPairSlots) places.put(i, j);
    });
  }
};

/// The same for those of a chunk. Bytes per pair: as above.
struct WriteChunks {
  static constexpr const char* name = "write_chunks";
  FoundPairs found;
  PairPlaces places;

  SCREE_HD void operator()(Index c) const {
    if (c >= *found.chunk_count || !found.had_chunks_enough()) return;
    places.put_slots(found.chunk_body[c], [&](Index n) { return found.in_chunk(c, n); });
  }
};

/// Cuts the list into pieces; one more element than owned bodies, for its end.
/// Bytes per body: 16 read, 8 written per piece.
struct CutPieces {
  static constexpr const char* name = "cut_pieces";
  Index owned_count = 0;
  Span<const Offset> begin;  ///< [owned_count + 1]
  Span<Index> piece_body;    ///< out
  Span<Index> piece_begin;   ///< out, one more

  SCREE_HD void operator()(Index a) const {
    Offset piece = first_piece(a, begin[a]);
    if (a == owned_count) {
      piece_begin[piece] = static_cast<Index>(begin[a]);
      return;
    }
    const Offset end = first_piece(a + 1, begin[a + 1]);
    for (Offset from = begin[a]; piece < end; from = (from / kPieceLength + 1) * kPieceLength) {
      piece_body[piece] = a;
      piece_begin[piece++] = static_cast<Index>(from);
    }
  }
};

/// The list of a candidate among those of lower bodies. Bytes: 4.
struct LowerBodyOf {
  Span<const Index> lower;  ///< of each pair
  SCREE_HD Index operator()(Index k, Index) const { return lower[k]; }
};

}  // namespace scree
