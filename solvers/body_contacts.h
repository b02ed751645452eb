#pragma once
// The body-to-contact lists of a contact problem: as A a range of the sorted contacts,
// as B a sorted list.

#include "kernels/backend/backend.h"
#include "kernels/backend/ordered_lists.h"
#include "kernels/contact/body_contacts.h"
#include "kernels/contact/contact_problem.h"

namespace scree {

template <class B>
class BodyContacts {
 public:
  explicit BodyContacts(B& b) : a_start_(b), b_start_(b), b_contact_(b) {}

  /// Builds the lists and points the problem at them; one host read.
  /// Bytes, see body_contacts_traffic(): 32 a contact and 32 a body.
  /// Memory: 8 bytes a body and 4 a contact, and 12 a body and 4 a contact more while it works; see
  /// order_lists() for bodies with very many contacts.
  /// @param p  with contact_count, free_count, body_a (sorted) and body_b set
  template <class Real>
  void build(B& b, ContactProblem<Real>& p) {
    const Index n = p.contact_count, bodies = p.free_count;
    a_start_.reserve_discard(bodies + 1);
    b_start_.reserve_discard(bodies + 1);
    b_contact_.reserve_discard(n);
    const Span<Index> a_start = a_start_.view(bodies + 1), b_start = b_start_.view(bodies + 1);
    const Span<Index> contact = b_contact_.view(n);
    for_each(b, n + 1, RunStarts<Index>{p.body_a.first(n), n, bodies, a_start});

    const Span<const Index> body_b = p.body_b.first(n);
    Buffer<B, Index> counters(b, bodies + 1), unordered(b, n);
    const Span<Index> count = counters.view(bodies);
    Buffer<B, Offset> start(b, static_cast<Offset>(bodies) + 1);
    fill(b, counters.view(), Index(0));
    for_each(b, n, CountAsB{body_b, bodies, count});
    exclusive_scan(b, Span<const Index>(count), start.view());
    for_each(b, n, PutAsB{body_b, bodies, start.view(), count, unordered.view()});
    const UnorderedLists<BodyBOf> lists{{body_b}, unordered.view(), start.view()};
    order_lists(b, n, lists, contact, counters.data() + bodies);
    for_each(b, bodies + 1, NarrowStarts{start.view(), b_start});
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
