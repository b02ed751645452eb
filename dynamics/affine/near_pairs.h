#pragma once
// Lists of near pairs in backend memory. Three host reads a search: bodies, features and pairs are counted before they are listed,
// so that buffers hold all of them.

#include "dynamics/affine/surface_tables.h"

namespace scree::affine {

template <class B>
class NearPairs {
 public:
  explicit NearPairs(B& b)
      : bounds_(b),
        key_(b),
        order_(b),
        count_(b),
        begin_(b),
        pair_key_(b),
        unused_(b),
        sort_(b),
        body_pair_(b),
        item_begin_(b),
        near_(b) {}

  /// Lists all pairs of features whose boxes come within a distance while bodies move straight from one place to another,
  /// but those of bodies that do not touch.
  /// @param from, to  by body
  void build(B& b, const SurfaceTables<B>& tables, Span<const AffineVec> from,
             Span<const AffineVec> to, double distance) {
    const Index bodies = tables.body_count();
    const auto count_of_all = static_cast<std::uint64_t>(bodies);
    surfaces_ = tables.view();
    pair_count_ = near_count_ = 0;
    if (bodies < 2) return;
    bounds_.reserve_discard(bodies), key_.reserve_discard(bodies), order_.reserve_discard(bodies);
    copy(b, tables.listed(), order_.view(bodies));
    const Index swept_count = tables.swept_count();
    for_each(b, bodies,
             BoundBodies{surfaces_, from, to, tables.listed(), bounds_.view(bodies),
                         key_.view(swept_count), order_.view(bodies)});
    sort_pairs(b, sort_, key_.view(swept_count), order_.view(swept_count), 64);
    SweepBodies sweep{bounds_.view(bodies),
                      order_.view(bodies),
                      swept_count,
                      tables.filter(),
                      distance,
                      {},
                      {},
                      {},
                      count_of_all};
    count_.reserve_discard(bodies);
    sweep.count = count_.view(bodies);
    for_each(b, bodies, sweep);
    pair_count_ = scan(b, bodies, begin_);
    if (pair_count_ == 0) return;
    pair_key_.reserve_discard(pair_count_), unused_.reserve_discard(pair_count_);
    sweep.begin = begin_.view(static_cast<Offset>(bodies) + 1);
    sweep.pair = pair_key_.view(pair_count_);
    for_each(b, bodies, sweep);
    sort_pairs(b, sort_, pair_key_.view(pair_count_), unused_.view(pair_count_),
               bits_for(count_of_all * count_of_all));
    list_features(b, from, to, distance, count_of_all);
  }

  NearPairsView view() const {
    return {near_.view(near_count_), body_pair_.view(pair_count_), surfaces_.corners};
  }

 private:
  void list_features(B& b, Span<const AffineVec> from, Span<const AffineVec> to, double distance,
                     std::uint64_t bodies) {
    body_pair_.reserve_discard(pair_count_), count_.reserve_discard(pair_count_);
    for_each(b, pair_count_,
             CountFeatures{surfaces_, pair_key_.view(pair_count_), bodies,
                           body_pair_.view(pair_count_), count_.view(pair_count_)});
    const Index items = scan(b, pair_count_, item_begin_);
    count_.reserve_discard(items);
    SearchFeature search{surfaces_,
                         from,
                         to,
                         bounds_.view(bounds_.capacity()),
                         body_pair_.view(pair_count_),
                         item_begin_.view(static_cast<Offset>(pair_count_) + 1),
                         distance,
                         count_.view(items),
                         {},
                         {}};
    for_each(b, items, search);
    near_count_ = scan(b, items, begin_);
    near_.reserve_discard(near_count_);
    search.begin = begin_.view(static_cast<Offset>(items) + 1);
    search.found = near_.view(near_count_);
    for_each(b, items, search);
    for_each(b, pair_count_,
             RangeOfPair{search.item_begin, search.begin, body_pair_.view(pair_count_)});
  }

  /// Sums of count_ into a buffer. @return all of them. @throws DeviceError when there are more than places have numbers
  Index scan(B& b, Index count, Buffer<B, Offset>& begin) {
    begin.reserve_discard(static_cast<Offset>(count) + 1);
    exclusive_scan(b, Span<const Index>(count_.view(count)),
                   begin.view(static_cast<Offset>(count) + 1));
    const Offset all = fetch(b, begin.data() + count);
    if (all > kMostPlaces) throw DeviceError("near pairs: too many to number them with 32 bits");
    return static_cast<Index>(all);
  }
  static constexpr Offset kMostPlaces = 2'000'000'000;

  SurfacesView surfaces_;
  Buffer<B, Bounds> bounds_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> order_, count_;
  Buffer<B, Offset> begin_;
  Buffer<B, std::uint64_t> pair_key_;
  Buffer<B, Index> unused_;  ///< goes with the names of pairs as they are sorted
  SortSpace<B> sort_;
  Buffer<B, BodyPair> body_pair_;
  Buffer<B, Offset> item_begin_;
  Buffer<B, NearPair> near_;
  Index pair_count_ = 0, near_count_ = 0;
};

}  // namespace scree::affine
