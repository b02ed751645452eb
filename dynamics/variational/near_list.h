#pragma once
// Which bodies are near each body, kept over several steps: as long as no body is farther from where it was when they
// were listed than the room that was left for it.

#include <algorithm>
#include <cmath>
#include <vector>

#include "collision/pair_candidates.h"
#include "kernels/backend/ordered_lists.h"
#include "kernels/variational/fly.h"

namespace scree {

/// Memory: 24 bytes a body for where it was, 8 for its list and 8 a pair of near bodies; 16 bytes a pair more, and
/// the bins, while it lists.
template <class B>
class NearList {
 public:
  /// @param fixed  storage indices of the fixed spheres
  NearList(B& b, const Vec3d& period, const std::vector<Index>& fixed)
      : period_(period), pairs_(b), begin_(b), other_(b), fixed_(b), origin_(b), fastest_(b, 1) {
    upload(b, fixed, fixed_);
  }

  bool is_kept() const { return is_kept_; }
  void forget() { is_kept_ = false; }

  /// How far bodies may be from where they were [m]; kNever: anywhere.
  double room() const { return room_; }
  NearBodies view() const {
    return {begin_.view(begin_.capacity()), other_.view(other_.capacity())};
  }
  Span<const Vec3d> origin() const { return origin_.view(origin_.capacity()); }

  /// Lists what is near each body now. A few host reads.
  /// @param widening  how often the room was too small for this step
  void build(B& b, const BodyView<double>& bodies, const Vec3d& gravity, double h, double diameter,
             int widening) {
    if (bodies.owned_count + fixed_.capacity() <= kFew) {
      list_all(b, bodies.owned_count);
    } else {
      room_ = std::ldexp(room_for(b, bodies, gravity, h, diameter), widening);
      list_near(b, bodies);
    }
    is_kept_ = true;
  }

 private:
  /// So few bodies are all near each other.
  static constexpr Index kFew = 48;
  /// Steps of the fastest body that there is room for, at least and at most: lists that are long cost each step, and
  /// those that do not last must be made again. In between, room is a part of the diameter.
  static constexpr double kLeastSteps = 4, kMostSteps = 16, kPartOfDiameter = 0.15;

  double room_for(B& b, const BodyView<double>& bodies, const Vec3d& gravity, double h,
                  double diameter) {
    reduce<Largest<double>>(b, bodies.owned_count, FastestBody{bodies.velocity},
                            StoreResult<Largest<double>>{fastest_.data()});
    const double speed = fetch(b, fastest_.data()).value;
    const double way = h * (speed + h * norm(gravity));
    const double room =
        std::max(kLeastSteps * way, std::min(kMostSteps * way, kPartOfDiameter * diameter));
    return std::max(room, 1e-6 * diameter);
  }

  void list_all(B& b, Index owned) {
    room_ = kNever;
    const Span<const Index> fixed = fixed_.view(fixed_.capacity());
    const Offset total = owned * (owned - 1 + fixed.size);
    for_each(b, owned + 1,
             AllNear{owned, fixed, begin_.resize_discard(owned + 1), other_.resize_discard(total)});
  }

  void list_near(B& b, const BodyView<double>& bodies) {
    const Index n = bodies.owned_count;
    ContactRange range;
    range.envelope = 2 * room_;
    range.period = period_;
    pairs_.build(b, bodies, range, {});
    const CandidateView pairs = pairs_.view();
    Buffer<B, Index> counters(b, static_cast<Offset>(n) + 1);
    fill(b, counters.view(), Index(0));
    const Span<Index> count = counters.view(n);
    for_each(b, pairs.piece_count(), CountNear{pairs, n, count});
    const Span<Offset> begin = begin_.resize_discard(static_cast<Offset>(n) + 1);
    exclusive_scan(b, Span<const Index>(count), begin);
    const Offset total = fetch(b, begin.data + n);
    if (!can_number(total)) checked_index(total, false, "neighbors of bodies");
    Buffer<B, Index> body(b, total), unordered(b, total);
    for_each(b, pairs.piece_count(),
             PlaceNear{pairs, n, begin, count, body.view(), unordered.view()});
    pairs_.release();
    const UnorderedLists<OwnerOf> lists{{body.view()}, unordered.view(), begin};
    order_lists(b, static_cast<Index>(total), lists, other_.resize_discard(total),
                counters.data() + n);
    copy(b, Span<const Vec3d>(bodies.position.first(n)), origin_.resize_discard(n));
  }

  Vec3d period_;
  PairCandidates<B, double> pairs_;
  Buffer<B, Offset> begin_;
  Buffer<B, Index> other_, fixed_;
  Buffer<B, Vec3d> origin_;
  Buffer<B, Largest<double>> fastest_;
  double room_ = 0;
  bool is_kept_ = false;
};

}  // namespace scree
