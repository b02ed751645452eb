#pragma once
// Contacts between bodies of any shapes. Memory while a step searches for contacts: 12 bytes a piece of the candidates,
// 28 and four stored contacts a near pair (44 bytes each in float), 8 a contact.

#include <type_traits>
#include <utility>
#include <vector>

#include "collision/numbering.h"
#include "kernels/narrow_phase/mixed_contacts.h"

namespace scree {

template <class B, class Real>
class MixedContacts {
 public:
  using Test = ContactTest<ShapeMix::any, Real>;

  explicit MixedContacts(B& b)
      : is_near_(b),
        touching_(b),
        begin_(b),
        body_a_(b),
        body_b_(b),
        count_(b),
        contact_(b),
        slot_(b),
        ranges_(b, PairList::kBodyPairs + 1),
        space_(b) {}

  /// Finds the contacts of bodies with each other, and counts those and the contacts with planes; two host reads.
  /// @param count  [piece count] out
  void find(B& b, const Test& test, Span<Index> count) {
    const Index pieces = test.candidates.piece_count();
    is_near_.resize_discard(pieces), touching_.resize_discard(pieces);
    begin_.resize_discard(static_cast<Offset>(pieces) + 1);
    for_each(b, pieces, FlagNearPairs<Real>{test, count, is_near_.view(), touching_.view()});
    exclusive_scan(b, Span<const Index>(count), begin_.view());
    const Offset near = fetch(b, begin_.data() + pieces);
    pair_count_ = checked_index(near, can_number(near), "near pairs of bodies");
    body_a_.resize_discard(near), body_b_.resize_discard(near), count_.resize_discard(near);
    contact_.resize_discard(near * PairContacts<Real>::kSlots);
    if (near > 0) find_contacts(b, test);
    for_each(b, pieces,
             CountMixedContacts<Real>{test, pairs(), std::as_const(count_).view(near), count});
  }

  /// Writes the keys of these contacts. @param begin  [piece count + 1] scan of the counts of all contacts
  void write_keys(B& b, const Test& test, Span<const Offset> begin, Span<std::uint64_t> key) {
    for_each(
        b, test.candidates.piece_count(),
        WriteMixedKeys<Real>{test, pairs(), found(), begin, key, slot_.resize_discard(key.size)});
  }

  /// Follows GroupKeys.
  void group(B& b, Span<const Index> flag, Span<const Offset> before, Offset radial_count) {
    Buffer<B, Offset> grouped(b, flag.size);
    for_each(b, static_cast<Index>(flag.size),
             GroupSlots{slot_.view(), flag, before, radial_count, grouped.view()});
    swap(slot_, grouped);
  }

  /// @param has_passes  see two_spheres()
  void fill(B& b, const Test& test, bool has_passes, Span<const std::uint64_t> key,
            const ContactArrays<Real>& out) {
    const auto fill_contacts = [&]<bool kPasses>(std::bool_constant<kPasses>) {
      for_each(b, static_cast<Index>(key.size),
               FillMixedContacts<kPasses, Real>{test, key, slot_.view(), contact_.view(), out});
    };
    if (has_passes) {
      fill_contacts(std::true_type{});
    } else {
      fill_contacts(std::false_type{});
    }
  }

  void release() {
    pair_count_ = 0;
    is_near_.release(), touching_.release(), begin_.release();
    body_a_.release(), body_b_.release(), count_.release();
    contact_.release(), slot_.release();
  }

 private:
  NearPairs pairs() const {
    return {begin_.view(begin_.capacity()), is_near_.view(is_near_.capacity()),
            touching_.view(touching_.capacity())};
  }
  PairContacts<Real> found() { return {count_.view(), contact_.view()}; }

  /// Sorts the pairs by pair function, so that threads beside each other run the same one, and each program has the
  /// registers and the stack of its own.
  void find_contacts(B& b, const Test& test) {
    const Index n = pair_count_;
    Buffer<B, std::uint64_t> function(b, n);
    Buffer<B, Index> pair(b, n);
    for_each(b, test.candidates.piece_count(),
             ListNearPairs<Real>{test, pairs(), body_a_.view(), body_b_.view(), function.view(),
                                 pair.view()});
    sort_pairs(b, space_, function.view(), pair.view(), bits_for(PairList::kBodyPairs + 1));
    for_each(b, PairList::kBodyPairs + 1, FindFunctionRanges{function.view(), ranges_.view()});
    const std::vector<Index> begin = download(b, Span<const Index>(ranges_.view()));
    function.release();
    scree::fill(b, count_.view(), Index(0));  // pairs without a function have no contacts
    PairList::for_each_body_pair([&]<class P>(P, int number) {
      const auto f = static_cast<std::size_t>(number);
      const Span<const Index> of_function{pair.data() + begin[f], begin[f + 1] - begin[f]};
      for_each(b, static_cast<Index>(of_function.size),
               FindPairContacts<ProgramOf<P>, Real>{test, P::A::kind, body_a_.view(),
                                                    body_b_.view(), of_function, found()});
    });
  }

  Index pair_count_ = 0;
  Buffer<B, std::uint32_t> is_near_, touching_;
  Buffer<B, Offset> begin_;
  Buffer<B, Index> body_a_, body_b_, count_;
  Buffer<B, FoundContact<Real>> contact_;
  Buffer<B, Offset> slot_;
  Buffer<B, Index> ranges_;
  SortSpace<B> space_;
};

}  // namespace scree
