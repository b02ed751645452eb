#pragma once
// Lists of the contacts of each free body: as A a range of the sorted contacts, as B a sorted list.

#include "kernels/backend/backend.h"
#include "kernels/body_contacts.h"

namespace scree {

/// A body's contacts as A are the range [a_start[i], a_start[i+1]), as B the listed ones.
struct BodyListView {
  Span<const Index> a_start;    ///< [free_count + 1]
  Span<const Index> b_start;    ///< [free_count + 1]
  Span<const Index> b_contact;  ///< contact indices sorted by (body_b, contact)
};

template <class B>
class BodyLists {
 public:
  explicit BodyLists(B& b) : a_start_(b), b_start_(b), b_contact_(b) {}

  /// Bytes per contact: 12 written, then about 24 per 8 bits of the body index in the radix sort.
  /// @param body_a   [contact_count] ascending
  /// @param scratch  [contact_count] out: of no use afterwards
  BodyListView build(B& b, SortSpace<B>& sort, Index free_count, Span<const Index> body_a,
                     Span<const Index> body_b, Span<std::uint64_t> scratch) {
    const auto n = static_cast<Index>(body_a.size);
    a_start_.reserve_discard(free_count + 1);
    b_start_.reserve_discard(free_count + 1);
    b_contact_.reserve_discard(n);
    const Span<Index> a_start = a_start_.view(free_count + 1);
    const Span<Index> b_start = b_start_.view(free_count + 1);
    const Span<Index> contact = b_contact_.view(n);
    for_each(b, n, BodyBKeys{body_b, free_count, scratch, contact});
    sort_pairs(b, sort, scratch, contact, bits_for(static_cast<std::uint64_t>(free_count) + 1));
    for_each(b, n + 1, RunStarts<Index>{body_a, n, free_count, a_start});
    for_each(b, n + 1, RunStarts<std::uint64_t>{scratch, n, free_count, b_start});
    return {a_start, b_start, contact};
  }

 private:
  Buffer<B, Index> a_start_;
  Buffer<B, Index> b_start_;
  Buffer<B, Index> b_contact_;
};

}  // namespace scree
