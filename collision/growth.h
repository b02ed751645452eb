#pragma once
// How buffers grow: with some room to spare, so that slowly rising counts do not allocate each
// step.

#include "kernels/backend/backend.h"

namespace scree {

/// Makes room for `count` elements and hands out a view of them; old contents are lost when it has
/// to grow.
template <class B, class T>
Span<T> sized(Buffer<B, T>& buffer, Offset count) {
  if (count > buffer.capacity()) {
    const bool first = buffer.capacity() == 0;
    buffer.reserve_discard(first ? count : count + count / 8);
  }
  return buffer.view(count);
}

/// Workspace of a sort; each backend defines its own.
template <class B>
struct SortSpace;

}  // namespace scree
