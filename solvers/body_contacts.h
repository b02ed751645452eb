#pragma once
// The body-to-contact lists of a contact problem: as A a range of the sorted contacts, as B a
// sorted list.

#include "kernels/backend/backend.h"
#include "kernels/body_contacts.h"
#include "kernels/contact_problem.h"

namespace scree {

template <class B>
class BodyContacts {
 public:
  explicit BodyContacts(B& b) : a_start_(b), b_start_(b), b_contact_(b) {}

  /// Builds the lists and points the problem at them.
  /// Bytes per contact: 12 written, then about 24 per 8 bits of the body index in the radix sort.
  /// Memory: 8 bytes a body and 4 a contact, and 20 a contact more while it works.
  /// @param p  with contact_count, free_count, body_a (sorted) and body_b set
  template <class Real>
  void build(B& b, ContactProblem<Real>& p) {
    const Index n = p.contact_count, bodies = p.free_count;
    a_start_.reserve_discard(bodies + 1);
    b_start_.reserve_discard(bodies + 1);
    b_contact_.reserve_discard(n);
    const Span<Index> a_start = a_start_.view(bodies + 1), b_start = b_start_.view(bodies + 1);
    const Span<Index> contact = b_contact_.view(n);
    Buffer<B, std::uint64_t> key_of(b, n);
    const Span<std::uint64_t> key = key_of.view();
    SortSpace<B> sort(b);
    for_each(b, n, BodyBKeys{p.body_b.first(n), bodies, key, contact});
    sort_pairs(b, sort, key, contact, bits_for(static_cast<std::uint64_t>(bodies) + 1));
    for_each(b, n + 1, RunStarts<Index>{p.body_a.first(n), n, bodies, a_start});
    for_each(b, n + 1, RunStarts<std::uint64_t>{key, n, bodies, b_start});
    p.a_start = a_start;
    p.b_start = b_start;
    p.b_contact = contact;
  }

 private:
  Buffer<B, Index> a_start_;
  Buffer<B, Index> b_start_;
  Buffer<B, Index> b_contact_;
};

}  // namespace scree
