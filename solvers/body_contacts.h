#pragma once
// Lists of the contacts of each free body: as A a range of the sorted contacts, as B a sorted list.

#include "kernels/backend/backend.h"
#include "kernels/body_contacts.h"
#include "kernels/contact_problem.h"

namespace scree {

template <class B>
class BodyContacts {
 public:
  explicit BodyContacts(B& b) : a_start_(b), b_start_(b), b_contact_(b), key_(b), sort_(b) {}

  /// Builds the lists and points the problem at them.
  /// Bytes per contact: 12 written, then about 24 per 8 bits of the body index in the radix sort.
  /// @param p  with contact_count, free_count, body_a (sorted) and body_b set
  template <class Real>
  void build(B& b, ContactProblem<Real>& p) {
    const Index n = p.contact_count;
    a_start_.reserve_discard(p.free_count + 1);
    b_start_.reserve_discard(p.free_count + 1);
    key_.reserve_discard(n);
    b_contact_.reserve_discard(n);
    const Span<Index> a_start = a_start_.view(p.free_count + 1);
    const Span<Index> b_start = b_start_.view(p.free_count + 1);
    const Span<std::uint64_t> key = key_.view(n);
    const Span<Index> contact = b_contact_.view(n);
    for_each(b, n, BodyBKeys{p.body_b, p.free_count, key, contact});
    sort_pairs(b, sort_, key, contact, bits_for(static_cast<std::uint64_t>(p.free_count) + 1));
    for_each(b, n + 1, RunStarts<Index>{p.body_a, n, p.free_count, a_start});
    for_each(b, n + 1, RunStarts<std::uint64_t>{key, n, p.free_count, b_start});
    p.a_start = a_start;
    p.b_start = b_start;
    p.b_contact = contact;
  }

 private:
  Buffer<B, Index> a_start_;
  Buffer<B, Index> b_start_;
  Buffer<B, Index> b_contact_;
  Buffer<B, std::uint64_t> key_;
  SortSpace<B> sort_;
};

}  // namespace scree
