#pragma once
// A constant of every body in backend memory, see PerBody.

#include <optional>
#include <utility>
#include <vector>

#include "kernels/backend/backend.h"
#include "kernels/bodies/per_body.h"

namespace scree {

/// Opens a gap in an array, filled with one value.
template <class B, class T>
void open_gap(B& b, Buffer<B, T>& array, Index at, Index places, T filler) {
  const Offset count = array.capacity(), behind = count - at;
  Buffer<B, T> larger(b, count + places);
  const Span<T> to = larger.view();
  const Span<const T> from = std::as_const(array).view(count);
  copy(b, from.first(at), to.first(at));
  fill(b, Span<T>{to.data + at, places}, filler);
  copy(b, Span<const T>{from.data + at, behind}, Span<T>{to.data + at + places, behind});
  swap(array, larger);
}

template <class B, class T>
class ConstantArray {
 public:
  /// @param fixed_begin  storage index behind the free bodies
  /// @param shared       value of all free bodies; none: each has its own
  /// @param filler       of bodies not loaded yet
  ConstantArray(B& b, Index fixed_begin, Index count, const std::optional<T>& shared, T filler)
      : first_(shared ? fixed_begin : 0),
        shared_(shared.value_or(filler)),
        array_(b, count - first_),
        shared_on_backend_(b) {
    fill(b, array_.view(), filler);
  }

  /// Fixed bodies move back in storage by so many places. @param fixed_begin  before it
  void grow(B& b, Index fixed_begin, Index shift) {
    if (first_ > 0) {
      first_ += shift;
    } else {
      open_gap(b, array_, fixed_begin, shift, shared_);
    }
  }

  PerBody<T> view() const {
    PerBody<T> v(array_.view(array_.capacity()));
    v.first = first_;
    v.shared = shared_;
    return v;
  }
  /// Stores the values of bodies from storage index `begin` on; shared ones are known already.
  void put(B& b, Index begin, const std::vector<T>& values) {
    if (begin < first_) return;
    upload(b, values.data(),
           Span<T>{array_.data() + (begin - first_), static_cast<Offset>(values.size())});
  }
  /// Values of the free bodies in backend memory: one for all of them, or one for each.
  struct OfFreeBodies {
    const T* data = nullptr;
    bool is_shared = false;
  };
  OfFreeBodies of_free_bodies(B& b) {
    if (first_ == 0) return {array_.data(), false};
    if (shared_on_backend_.capacity() == 0) {
      shared_on_backend_.reserve_discard(1);
      upload(b, &shared_, shared_on_backend_.view());
    }
    return {shared_on_backend_.data(), true};
  }
  /// Calls f(array) where free bodies have their own values, for reordering.
  template <class F>
  void if_stored(F&& f) {
    if (first_ == 0) f(array_);
  }

 private:
  Index first_ = 0;
  T shared_;
  Buffer<B, T> array_;
  Buffer<B, T> shared_on_backend_;  ///< empty until a program asks for it
};

}  // namespace scree
