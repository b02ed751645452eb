#pragma once
// The body-to-contact lists of a contact problem, of each of its groups: as A a range of the sorted
// contacts, as B a sorted list.

#include "kernels/backend/backend.h"
#include "kernels/backend/ordered_lists.h"
#include "kernels/contact/body_contacts.h"
#include "kernels/contact/contact_problem.h"

namespace scree {

/// The lists of one group.
template <class B>
class GroupContacts {
 public:
  explicit GroupContacts(B& b) : a_start_(b), b_start_(b), b_contact_(b) {}

  /// Builds the lists; one host read.
  /// Bytes, see body_contacts_traffic(): 32 a contact and 32 a body.
  /// Memory: 8 bytes a body and 4 a contact, and 12 a body and 4 a contact more while it works; see
  /// order_lists() for bodies with very many contacts.
  /// @param body_a, body_b  of the contacts of the group; body_a ascending
  ContactLists build(B& b, Index owned_count, Span<const Index> body_a, Span<const Index> body_b) {
    const auto n = static_cast<Index>(body_a.size);
    const Index bodies = owned_count;
    a_start_.reserve_discard(bodies + 1);
    b_start_.reserve_discard(bodies + 1);
    b_contact_.reserve_discard(n);
    const Span<Index> a_start = a_start_.view(bodies + 1), b_start = b_start_.view(bodies + 1);
    const Span<Index> contact = b_contact_.view(n);
    if (n < bodies / 4 || (B::kIsDevice && bodies < kFewBodies)) {
      for_each(b, bodies + 1, SearchStarts<Index>{body_a, n, a_start});
    } else {
      for_each(b, n + 1, RunStarts<Index>{body_a, n, bodies, a_start});
    }

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
    return {0, a_start, b_start, contact};
  }

 private:
  /// Up to so many bodies on a GPU a search for each takes less time than what one thread writes for a long gap: some 10 us, where
  /// gaps in a drum of 90,000 grains take 70.
  static constexpr Index kFewBodies = 250'000;

  Buffer<B, Index> a_start_;
  Buffer<B, Index> b_start_;
  Buffer<B, Index> b_contact_;
};

template <class B>
class BodyContacts {
 public:
  explicit BodyContacts(B& b) : first_(b), general_(b) {}

  /// Builds the lists of all groups and points the problem at them; one host read for each.
  /// @param p  with layout, counts, body_a (sorted in each group) and body_b set
  template <class Real>
  void build(B& b, ContactProblem<Real>& p) {
    const bool is_mixed = p.layout == ContactLayout::mixed;
    const Index n = is_mixed ? p.radial_count : p.contact_count;
    const ContactLists first =
        first_.build(b, p.bodies.owned_count, p.body_a.first(n), p.body_b.first(n));
    p.a_start = first.a_start;
    p.b_start = first.b_start;
    p.b_contact = first.b_contact;
    if (!is_mixed) return;
    const Index general = p.contact_count - n;
    p.later[0] = general_.build(b, p.bodies.owned_count, {p.body_a.data + n, general},
                                {p.body_b.data + n, general});
    p.later[0].first = n;
  }

 private:
  GroupContacts<B> first_;
  GroupContacts<B> general_;  ///< of the mixed layout
};

}  // namespace scree
