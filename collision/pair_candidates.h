#pragma once
// The list of pairs of bodies that may touch, kept over several steps.

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "collision/broad_phase.h"
#include "kernels/pair_candidates.h"

namespace scree {

/// Memory for the time a list is made.
template <class B, class Real>
struct ListSpace {
  Buffer<B, Index>& count;
  Buffer<B, Offset>& begin;
  Buffer<B, Vec3<Real>>& scratch;

  /// The scratch memory as whole numbers.
  Span<Index> numbers(Offset n) {
    constexpr Offset kPerVector = sizeof(Vec3<Real>) / sizeof(Index);
    sized(scratch, (n + kPerVector - 1) / kPerVector);
    return {reinterpret_cast<Index*>(scratch.data()), n};
  }
};

/// Memory: 16 bytes a binned body, 8 a free body and 4.25 a pair.
template <class B, class Real>
class PairCandidates {
 public:
  explicit PairCandidates(B& b) : record_(b), body_(b), begin_(b), other_(b), left_(b, 1) {}

  /// Whether the list holds every pair that may touch within the range. It does not after
  /// forget(), when there are other bodies than before, or when one left its ball; else nothing
  /// but where bodies are now counts, so any range may come. One host read.
  /// Bytes per binned body: 60.
  bool covers(B& b, const BodyView<Real>& bodies, const ContactRange& range) {
    const BinnedRange binned{bodies.free_count, bodies.fixed_begin, bodies.count};
    if (!is_kept_ || binned != binned_) return false;
    reduce<LeftBodies>(
        b, binned.size(),
        CheckReach<Real>{bodies, binned, range, origin_, record_.view(binned.size())},
        StoreResult<LeftBodies>{left_.data()});
    return fetch(b, left_.data()).count == 0;
  }

  /// Makes the list for the range and some way beyond; two host reads, one of them by the bins.
  /// Bytes per body besides the bins, m candidates each, every array counted once: 44 for the
  /// balls, 44 + 12 m to search, 48 + 28 m to put into order (m is about 5 in a dense bed).
  /// @param spare  without skin the list serves only one listing
  /// @throws std::runtime_error when there are more pairs than an Index can number
  void build(B& b, BroadPhase<B, Real>& broad_phase, SortSpace<B>& sort, ListSpace<B, Real> space,
             const BodyView<Real>& bodies, const ContactRange& range, const SpareReach& spare) {
    forget();
    const Index n = bodies.free_count;
    const BinView bins = broad_phase.build(b, sort, bodies, range, spare);
    binned_ = {n, bodies.fixed_begin, bodies.count};
    origin_ = bins.lower;
    for_each(
        b, binned_.size(),
        RecordReach<Real>{bodies, binned_, origin_, bins.inflated, sized(record_, binned_.size())});

    const PairSearch search{bodies.position, bodies.fixed_begin, bins};
    const auto positions = static_cast<Index>(bins.body.size);
    const Span<Index> found = space.numbers(static_cast<Offset>(positions) * kPairSlots);
    const Span<Index> count = sized(space.count, n);
    const Span<Offset> first = sized(space.begin, static_cast<Offset>(n) + 1);
    fill(b, count, Index(0));
    for_each(b, positions, CountCandidates{search, positions, count, found});
    exclusive_scan(b, Span<const Index>(count), first);
    const Offset total = fetch(b, first.data + n);
    const Offset pieces = first_piece(n, total);
    if (total >= std::numeric_limits<Index>::max() || pieces >= std::numeric_limits<Index>::max()) {
      throw std::runtime_error(std::to_string(total) +
                               " pairs of near bodies are more than one run can number (2^31)");
    }
    const Span<Index> other = sized(other_, total);
    for_each(b, positions, WriteCandidates{search, positions, found, first, count, other});

    piece_count_ = static_cast<Index>(pieces);
    for_each(b, n + 1, CutPieces{n, first, sized(body_, pieces), sized(begin_, pieces + 1)});
    const Span<Index> ordered = space.numbers(total);
    for_each(b, piece_count_, OrderCandidates{view(total), first, ordered});
    copy(b, Span<const Index>(ordered), other);
    candidate_count_ = total;
    is_kept_ = spare.skin > 0;
    ++build_count_;
  }

  CandidateView view() const { return view(candidate_count_); }

  /// The next listing needs a new list: bodies changed places.
  void forget() { is_kept_ = false; }
  /// The same, and gives the memory back.
  void release(B& b) {
    forget();
    record_ = Buffer<B, ReachRecord>(b);
    body_ = Buffer<B, Index>(b);
    begin_ = Buffer<B, Index>(b);
    other_ = Buffer<B, Index>(b);
  }

  /// Lists made so far.
  std::int64_t build_count() const { return build_count_; }

 private:
  CandidateView view(Offset candidates) const {
    return {body_.view(piece_count_), begin_.view(static_cast<Offset>(piece_count_) + 1),
            other_.view(candidates)};
  }

  Buffer<B, ReachRecord> record_;
  Buffer<B, Index> body_;
  Buffer<B, Index> begin_;
  Buffer<B, Index> other_;
  Buffer<B, LeftBodies> left_;
  BinnedRange binned_;
  Vec3<double> origin_;
  Index piece_count_ = 0;
  Offset candidate_count_ = 0;
  bool is_kept_ = false;
  std::int64_t build_count_ = 0;
};

}  // namespace scree
