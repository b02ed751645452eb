#pragma once
// The list of pairs of bodies that may touch, kept over several steps.

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "collision/broad_phase.h"
#include "kernels/pair_candidates.h"

namespace scree {

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
  void build(B& b, const BodyView<Real>& bodies, const ContactRange& range,
             const SpareReach& spare) {
    release();
    const Index n = bodies.free_count;
    const Bins<B> bins = sort_into_bins(b, bodies, range, spare);
    binned_ = {n, bodies.fixed_begin, bodies.count};
    origin_ = bins.view.lower;
    for_each(b, binned_.size(),
             RecordReach<Real>{bodies, binned_, origin_, bins.view.inflated,
                               record_.resize_discard(binned_.size())});

    const PairSearch search{bodies.position, bodies.fixed_begin, bins.view};
    const Index positions = binned_.size();
    Buffer<B, Index> found(b, static_cast<Offset>(positions) * kPairSlots);
    Buffer<B, Index> count(b, n);
    Buffer<B, Offset> first(b, static_cast<Offset>(n) + 1);
    fill(b, count.view(), Index(0));
    for_each(b, positions, CountCandidates{search, positions, count.view(), found.view()});
    exclusive_scan(b, Span<const Index>(count.view()), first.view());
    const Offset total = fetch(b, first.data() + n);
    const Offset pieces = first_piece(n, total);
    if (total >= std::numeric_limits<Index>::max() || pieces >= std::numeric_limits<Index>::max()) {
      throw std::runtime_error(std::to_string(total) +
                               " pairs of near bodies are more than one run can number (2^31)");
    }
    Buffer<B, Index> lower(b, total), other(b, total);
    for_each(b, positions,
             WriteCandidates{search, positions, found.view(), first.view(), count.view(),
                             lower.view(), other.view()});
    found.release();
    for_each(b, n + 1,
             CutPieces{n, first.view(), body_.resize_discard(pieces),
                       begin_.resize_discard(pieces + 1)});
    for_each(
        b, static_cast<Index>(total),
        OrderCandidates{lower.view(), other.view(), first.view(), other_.resize_discard(total)});
    is_kept_ = spare.skin > 0;
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
    record_.release(), body_.release(), begin_.release(), other_.release();
  }

  /// Lists made so far.
  std::int64_t build_count() const { return build_count_; }

 private:
  Buffer<B, ReachRecord> record_;
  Buffer<B, Index> body_;
  Buffer<B, Index> begin_;
  Buffer<B, Index> other_;
  Buffer<B, LeftBodies> left_;
  BinnedRange binned_;
  Vec3<double> origin_;
  bool is_kept_ = false;
  std::int64_t build_count_ = 0;
};

}  // namespace scree
