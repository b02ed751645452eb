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
    add_up(b, mark, count);
    const auto found = static_cast<Index>(fetch(b, place_.data() + count));
    write_out(b, mark, count, found, marked);
    return found;
  }
  /// The same where it is known how many there are: no host read.
  void write(B& b, const Buffer<B, Index>& mark, Index count, Index found,
             Buffer<B, Index>& marked) {
    if (found == 0) return;
    add_up(b, mark, count);
    write_out(b, mark, count, found, marked);
  }

 private:
  void add_up(B& b, const Buffer<B, Index>& mark, Index count) {
    place_.reserve_discard(static_cast<Offset>(count) + 1);
    exclusive_scan(b, mark.view(count), place_.view(static_cast<Offset>(count) + 1));
  }
  void write_out(B& b, const Buffer<B, Index>& mark, Index count, Index found,
                 Buffer<B, Index>& marked) {
    marked.reserve_discard(found);
    for_each(b, count, ListMarked{mark.view(count), place_.view(count), marked.view(found)});
  }

  Buffer<B, Offset> place_;
};

}  // namespace scree::affine
