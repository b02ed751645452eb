#pragma once
// Rows of storage that change their places because those before them get more room, or less.

#include <algorithm>
#include <utility>

#include "kernels/backend/backend.h"

namespace scree {

/// Moves the rows of an array from a place on, back by so many places, which get one value, or forward over what was there.
template <class B, class T>
void move_rows(B& b, Buffer<B, T>& array, Index from, Index places, T filler) {
  const Offset count = array.capacity(), moved = count - from;
  const Offset kept = from + std::min(places, Index(0));
  Buffer<B, T> next(b, count + places);
  const Span<T> to = next.view();
  const Span<const T> now = std::as_const(array).view(count);
  copy(b, now.first(kept), to.first(kept));
  fill(b, Span<T>{to.data + kept, from + places - kept}, filler);
  copy(b, Span<const T>{now.data + from, moved}, Span<T>{to.data + from + places, moved});
  swap(array, next);
}

}  // namespace scree
