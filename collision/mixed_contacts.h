#pragma once
// Contacts between bodies of any shapes. Memory while a step searches for contacts: 12 bytes a piece of the candidates,
// 40 a near pair, 40 more for those of the search before while it searches once more, and 12 while pairs are sorted; four
// stored contacts, 32 bytes each in float, a pair that is computed, again in each search, and how its bodies lie: 16 bytes
// of two boxes, 112 of others without a closed form; 36 of these pairs of one program while that runs; 8 a contact.

#include <array>
#include <cstddef>
#include <stdexcept>
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
        slot_(b),
        notes_(b),
        before_(b),
        stores_{Store(b), Store(b), Store(b)},
        ranges_(b, PairList::kBodyPairs + 1),
        space_(b) {}

  /// Finds the contacts of bodies with each other, and counts those and the contacts with planes; two host reads. Of the
  /// searches since release() it keeps what holds: bodies and their places in memory must be the same.
  /// @param count  [piece count] out
  void find(B& b, const Test& test, Span<Index> count) {
    const Index pieces = test.candidates.piece_count();
    is_near_.resize_discard(pieces), touching_.resize_discard(pieces);
    begin_.resize_discard(static_cast<Offset>(pieces) + 1);
    for_each(b, pieces, FlagNearPairs<Real>{test, count, is_near_.view(), touching_.view()});
    exclusive_scan(b, Span<const Index>(count), begin_.view());
    const Offset near = fetch(b, begin_.data() + pieces);
    std::swap(notes_, before_);
    notes_.resize_discard(checked_index(near, can_number(near), "near pairs of bodies"));
    if (near > 0) find_contacts(b, test);
    before_.release();
    for_each(b, pieces, CountMixedContacts<Real>{test, pairs(), notes_.count.view(), count});
  }

  /// Writes the keys of these contacts. @param begin  [piece count + 1] scan of the counts of all contacts
  void write_keys(B& b, const Test& test, Span<const Offset> begin, Span<std::uint64_t> key) {
    for_each(b, test.candidates.piece_count(),
             WriteMixedKeys<Real>{test, pairs(), notes_.view(), begin, key,
                                  slot_.resize_discard(key.size)});
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
               FillMixedContacts<kPasses, Real>{test, key, slot_.view(), stores(), out});
    };
    if (has_passes) {
      fill_contacts(std::true_type{});
    } else {
      fill_contacts(std::false_type{});
    }
  }

  /// Pairs computed by the searches since release().
  Index computed_count() const { return place_count_; }

  /// Gives the memory back, and forgets what was found.
  void release() {
    is_near_.release(), touching_.release(), begin_.release(), slot_.release();
    notes_.release(), before_.release();
    for (Store& store : stores_) store.contact.release(), store.searches.release();
    store_count_ = 0;
    place_count_ = 0;
  }

 private:
  struct Notes {
    explicit Notes(B& b) : key(b), count(b), features(b), place(b), same(b) {}
    void resize_discard(Offset pairs) {
      key.resize_discard(pairs), count.resize_discard(pairs), features.resize_discard(pairs);
      place.resize_discard(pairs), same.resize_discard(pairs);
    }
    void release() {
      key.release(), count.release(), features.release(), place.release(), same.release();
    }
    PairNotes view() {
      return {key.view(), count.view(), features.view(), place.view(), same.view()};
    }

    Buffer<B, std::uint64_t> key;
    Buffer<B, Index> count;
    Buffer<B, PairFeatures> features;
    Buffer<B, Index> place;
    Buffer<B, SameList> same;
  };
  struct Store {
    explicit Store(B& b) : contact(b), searches(b) {}
    Buffer<B, FoundContact<Real>> contact;
    Buffer<B, std::byte> searches;  ///< of all programs in parts, one after the other
    Index begin = 0;
    /// Of each program.
    struct Part {
      Index begin = 0;  ///< place of its first pair
      Index count = 0;
      Offset byte = 0;  ///< of its first search
    };
    std::array<Part, PairList::kPrograms> parts;

    template <class Search>
    Span<Search> searches_of(int program) {
      static_assert(sizeof(Search) % 16 == 0 && alignof(Search) <= 16);
      const Part& part = parts[static_cast<std::size_t>(program)];
      // Without pairs there is no memory.
      return {part.count > 0 ? reinterpret_cast<Search*>(searches.data() + part.byte) : nullptr,
              part.count};
    }
  };

  NearPairs pairs() const {
    return {begin_.view(begin_.capacity()), is_near_.view(is_near_.capacity()),
            touching_.view(touching_.capacity())};
  }
  ContactStores<Real> stores() {
    ContactStores<Real> s;
    for (int k = 0; k < store_count_; ++k) {
      Store& store = stores_[static_cast<std::size_t>(k)];
      s.contact[k] = store.contact.view();
      s.begin[k] = store.begin;
    }
    s.count = store_count_;
    return s;
  }

  /// Sorts the pairs by pair function, so that threads beside each other run the same one, and each program has the
  /// registers and the stack of its own.
  void find_contacts(B& b, const Test& test) {
    if (store_count_ == kMostSearches) throw std::logic_error("more searches than a step has");
    const auto n = static_cast<Index>(notes_.key.capacity());
    Buffer<B, std::uint64_t> function(b, n);
    Buffer<B, Index> pair(b, n);
    for_each(b, test.candidates.piece_count(),
             ListNearPairs<Real>{test, pairs(), before_.view(), notes_.view(), function.view(),
                                 pair.view()});
    sort_pairs(b, space_, function.view(), pair.view(), bits_for(PairList::kBodyPairs + 1));
    for_each(b, PairList::kBodyPairs + 1, FindFunctionRanges{function.view(), ranges_.view()});
    const std::vector<Index> begin = download(b, Span<const Index>(ranges_.view()));
    function.release();
    Store& store = stores_[static_cast<std::size_t>(store_count_)];
    const Offset slots = Offset{begin.back()} * ContactStores<Real>::kSlots;
    store.contact.resize_discard(slots);
    store.begin = place_count_;
    Offset bytes = 0;
    PairList::for_each_program([&]<class P>(P, int program) {
      const Index first = begin[static_cast<std::size_t>(PairList::first_number(program))];
      const Index end = begin[static_cast<std::size_t>(PairList::first_number(program + 1))];
      store.parts[static_cast<std::size_t>(program)] = {place_count_ + first, end - first, bytes};
      if constexpr (InParts<P>) bytes += Offset{end - first} * Offset{sizeof(typename P::Search)};
    });
    store.searches.resize_discard(bytes);
    PairList::for_each_program([&]<class P>(P, int program) {
      const typename Store::Part& part = store.parts[static_cast<std::size_t>(program)];
      const Index first = part.begin - place_count_;
      const Offset slot = Offset{first} * ContactStores<Real>::kSlots;
      const Offset used = Offset{part.count} * ContactStores<Real>::kSlots;
      const ComputedPairs<P, Real> pairs{test,
                                         {pair.data() + first, part.count},
                                         notes_.view(),
                                         part.begin,
                                         {store.contact.data() + slot, used}};
      if (part.count == 0) return;
      if constexpr (InParts<P>) {
        find_in_parts(b, pairs, program);
      } else {
        for_each(b, part.count, FindPairContacts<P, Real>{pairs});
      }
    });
    ++store_count_;
    const Offset places = Offset{place_count_} + begin.back();
    place_count_ = checked_index(places, can_number(places), "near pairs of bodies");
  }

  /// Each part of the program for all pairs that need it, so that threads beside each other do the same.
  template <class P>
  void find_in_parts(B& b, const ComputedPairs<P, Real>& pairs, int program) {
    using Search = typename P::Search;
    SearchStores<Search> before;
    for (int k = 0; k < store_count_; ++k) {
      Store& store = stores_[static_cast<std::size_t>(k)];
      before.search[k] = store.template searches_of<Search>(program);
      before.begin[k] = store.parts[static_cast<std::size_t>(program)].begin;
    }
    before.count = store_count_;
    const Span<Search> search =
        stores_[static_cast<std::size_t>(store_count_)].template searches_of<Search>(program);
    const auto n = static_cast<Index>(pairs.pair.size);
    const Index more = Finishes<P> ? n : 0;
    Buffer<B, Index> is_near(b, n), is_open(b, more), is_long(b, more);
    Buffer<B, Index> list(b, n), others(b, more);
    Buffer<B, Offset> scan(b, Offset{n} + 1), scan_of_others(b, Offset{more} + 1);
    for_each(b, n,
             SearchPairs<P, Real>{pairs, before, search, is_near.view(), is_open.view(),
                                  is_long.view()});
    const auto flagged = [&](Buffer<B, Index>& flag, Buffer<B, Offset>& before_each,
                             Buffer<B, Index>& to) -> FlaggedList {
      exclusive_scan(b, Span<const Index>(flag.view()), before_each.view());
      for_each(b, n, ListFlagged{flag.view(), before_each.view(), to.view()});
      return {to.view(), before_each.data() + n};
    };
    FlaggedLists near;
    if constexpr (Finishes<P>) {
      const FlaggedLists open{flagged(is_long, scan, list),
                              flagged(is_open, scan_of_others, others)};
      // Flags of pairs that are open, and those of deep ones, say from here on whether they may pass.
      for_each(b, n, FinishPairs<P, Real>{pairs, open, search, is_open.view()});
      for_each(b, n, PassPairs<P, Real>{pairs, flagged(is_open, scan, list), search});
      for_each(b, n, SplitByFacets<P>{search, is_near.view(), is_long.view()});
      near.first = flagged(is_long, scan, list);
      near.second = flagged(is_near, scan_of_others, others);
    } else {
      near.first = flagged(is_near, scan, list);
    }
    for_each(b, n, FindSearchedContacts<P, Real>{pairs, near, search});
  }

  Buffer<B, std::uint32_t> is_near_, touching_;
  Buffer<B, Offset> begin_;
  Buffer<B, Offset> slot_;
  Notes notes_, before_;  ///< of this search, and of the one before
  std::array<Store, kMostSearches> stores_;
  int store_count_ = 0;
  Index place_count_ = 0;  ///< in all stores
  Buffer<B, Index> ranges_;
  SortSpace<B> space_;
};

}  // namespace scree
