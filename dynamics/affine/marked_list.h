#pragma once
// Places of an array that are marked, as a list.

#include "kernels/affine/assembly.h"
#include "kernels/backend/backend.h"

namespace scree::affine {

template <class B>
class MarkedList {
 public:
  explicit MarkedList(B& b) : place_(b) {}

  /// Lists each place as often as its mark says; one host read. @return how many there are
  Index list(B& b, const Buffer<B, Index>& mark, Index count, Buffer<B, Index>& marked) {
    if (count == 0) return 0;
    place_.reserve_discard(static_cast<Offset>(count) + 1);
    const Span<const Index> marks = mark.view(count);
    exclusive_scan(b, marks, place_.view(static_cast<Offset>(count) + 1));
    const auto found = static_cast<Index>(fetch(b, place_.data() + count));
    marked.reserve_discard(found);
    for_each(b, count, ListMarked{marks, place_.view(count), marked.view(found)});
    return found;
  }

 private:
  Buffer<B, Offset> place_;
};

}  // namespace scree::affine
