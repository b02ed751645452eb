#pragma once
// The order of owned bodies in storage: along the Morton curve, so that neighbors in space are
// neighbors in memory. Bodies move, so the order is renewed now and then.

#include <algorithm>

#include "kernels/backend/backend.h"
#include "kernels/bodies/body_order.h"
#include "kernels/bodies/permute.h"

namespace scree {

template <class B>
class BodyOrder {
 public:
  explicit BodyOrder(B& b)
      : key_(b), order_(b), new_of_old_(b), center_(b, 1), distance_(b, 1), scratch_(b), sort_(b) {}

  /// Mean distance between bodies that follow each other in storage [m]. It grows as the order
  /// decays: sort again when it has grown by half since the last sort. One host read.
  double spread(B& b, Span<const Vec3<double>> position) {
    const auto count = static_cast<Index>(position.size);
    if (count < 2) return 0;
    reduce<Sums<1>>(b, count - 1, StorageDistance{position},
                    StoreResult<Sums<1>>{distance_.data()});
    return fetch(b, distance_.data()).value[0] / (count - 1);
  }

  /// Computes the order for these positions; apply() then moves the arrays. No host read.
  /// @param late  the last ones in storage, until others come
  void compute(B& b, Span<const Vec3<double>> position, const LateBodies& late = {}) {
    count_ = static_cast<Index>(position.size);
    const Index measured = late.count < count_ ? count_ - late.count : count_;
    reduce<Sums<4>>(b, measured, SumPositions{position}, StoreResult<Sums<4>>{center_.data()});
    reduce<Sums<1>>(b, measured, SumDeviations{position, center_.data()},
                    StoreResult<Sums<1>>{distance_.data()});
    const Span<std::uint64_t> key = key_.resize_discard(count_);
    const Span<Index> order = order_.resize_discard(count_);
    for_each(b, count_, MortonKeys{position, center_.data(), distance_.data(), late, key, order});
    sort_pairs(b, sort_, key, order, MortonKeys::kLateBit + (late.count > 0 ? 1 : 0));
    for_each(b, count_, InvertOrder{order, new_of_old_.resize_discard(count_)});
  }

  /// [count] old storage index of the body that comes to each place.
  Span<const Index> order() const { return order_.view(count_); }
  /// [count] new storage index of each body.
  Span<const Index> new_of_old() const { return new_of_old_.view(count_); }

  /// Moves the first `count` elements of one array into the new order.
  template <class T>
  void apply(B& b, Span<T> array) {
    const auto bytes = static_cast<Offset>(sizeof(T)) * count_;
    const Span<T> moved{reinterpret_cast<T*>(scratch_.resize_discard((bytes + 7) / 8).data),
                        count_};
    for_each(b, count_, Gather<T>{order(), array.first(count_), moved});
    copy(b, Span<const T>(moved), array.first(count_));
  }

 private:
  Index count_ = 0;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> order_;
  Buffer<B, Index> new_of_old_;
  Buffer<B, Sums<4>> center_;
  Buffer<B, Sums<1>> distance_;
  Buffer<B, double> scratch_;
  SortSpace<B> sort_;
};

}  // namespace scree
