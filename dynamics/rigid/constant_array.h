#pragma once
// A constant of every body in backend memory, see PerBody.

#include <optional>
#include <vector>

#include "dynamics/rigid/move_rows.h"
#include "kernels/backend/backend.h"
#include "kernels/bodies/per_body.h"

namespace scree {

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

  /// Fixed bodies move in storage by so many places, see move_rows(). @param fixed_begin  before it
  void move_fixed(B& b, Index fixed_begin, Index shift) {
    if (first_ > 0) {
      first_ += shift;
    } else {
      move_rows(b, array_, fixed_begin, shift, shared_);
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
