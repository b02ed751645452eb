#pragma once
// The body-to-contact lists of a contact problem.

#include "kernels/body_lists.h"
#include "kernels/contact_problem.h"

namespace scree {

template <class B>
class BodyContacts {
 public:
  explicit BodyContacts(B& b) : lists_(b), key_(b), sort_(b) {}

  /// Builds the lists and points the problem at them.
  /// @param p  with contact_count, free_count, body_a (sorted) and body_b set
  template <class Real>
  void build(B& b, ContactProblem<Real>& p) {
    const Index n = p.contact_count;
    key_.reserve_discard(n);
    const BodyListView lists =
        lists_.build(b, sort_, p.free_count, p.body_a.first(n), p.body_b.first(n), key_.view(n));
    p.a_start = lists.a_start;
    p.b_start = lists.b_start;
    p.b_contact = lists.b_contact;
  }

 private:
  BodyLists<B> lists_;
  Buffer<B, std::uint64_t> key_;
  SortSpace<B> sort_;
};

}  // namespace scree
