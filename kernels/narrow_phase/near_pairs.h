#pragma once
// Pairs of bodies that are near enough to be computed: what is noted and stored of them while contacts are searched for.

#include "kernels/narrow_phase/contact_list.h"
#include "kernels/narrow_phase/list_flagged.h"
#include "kernels/narrow_phase/same_list.h"

namespace scree {

/// Pairs of bodies, not two spheres, that are near enough to be computed. Those of a piece of the candidates lie beside
/// each other, in the order of these.
struct NearPairs {
  Span<const Offset> begin;           ///< [piece count + 1] first pair of each piece
  Span<const std::uint32_t> is_near;  ///< [piece count] bit k: the k-th candidate is one
  Span<const std::uint32_t>
      touching;  ///< [piece count] bit k: the k-th candidate is a contact of two spheres
};

/// What is stored of a contact until all of them are counted: 32 bytes in float, without holes, since a device reads first what
/// it writes a part of. The two points of a contact lie over each other, so the lever arm of one body follows from that of the
/// other. That of the smaller one is kept: the rounding of a long arm would be too much for a short one.
template <class Real>
struct alignas(16) FoundContact {
  Vec3<Real> normal;
  Real gap = 0;
  Vec3<Real> arm;
  Real is_arm_of_b = 0;  ///< or 1

  FoundContact() = default;
  SCREE_HD FoundContact(const ContactGeometry& g, bool is_b_smaller)
      : normal(g.normal),
        gap(static_cast<Real>(g.gap)),
        arm(is_b_smaller ? g.arm_b : g.arm_a),
        is_arm_of_b(is_b_smaller ? Real(1) : Real(0)) {}
  /// @param d  center of A to center of B [m]
  SCREE_HD Vec3<Real> arm_a(const Vec3d& d) const {
    return is_arm_of_b > Real(0) ? Vec3<Real>(Vec3d(arm) - way() + d) : arm;
  }
  SCREE_HD Vec3<Real> arm_b(const Vec3d& d) const {
    return is_arm_of_b > Real(0) ? arm : Vec3<Real>(Vec3d(arm) + way() - d);
  }

 private:
  SCREE_HD Vec3d way() const { return static_cast<double>(gap) * Vec3d(normal); }
};

/// Features of the contacts of a pair, ascending.
struct PairFeatures {
  static constexpr int kBits = 16;
  std::uint64_t bits = 0;

  SCREE_HD void set(Index c, std::uint32_t feature) {
    bits |= static_cast<std::uint64_t>(feature) << (kBits * c);
  }
  SCREE_HD std::uint32_t operator[](Index c) const {
    return static_cast<std::uint32_t>(bits >> (kBits * c)) & ((1u << kBits) - 1);
  }
};
static_assert(PairFeatures::kBits * Manifold::kMaxContacts <= 64);

/// Searches of a step: one, and those with wider margins.
inline constexpr int kMostSearches = 3;

/// Where each search of a step stores what it computed of pairs: those from a place on.
struct StorePlaces {
  Index begin[kMostSearches] = {};  ///< place of the first pair of each
  int count = 0;

  /// The store that holds a pair's place.
  SCREE_HD int store_of(Index place) const {
    int k = count - 1;
    while (place < begin[k]) --k;
    return k;
  }
};

/// The contacts of computed pairs, kSlots for each.
template <class Real>
struct ContactStores : StorePlaces {
  static constexpr Index kSlots = Manifold::kMaxContacts;

  Span<FoundContact<Real>> contact[kMostSearches];  ///< [pairs computed][kSlots]

  SCREE_HD Offset slot(int store, Index place) const {
    return static_cast<Offset>(place - begin[store]) * kSlots;
  }
};

/// How two bodies lie, of the pairs of a program in parts: see InParts.
template <class Search>
struct SearchStores : StorePlaces {
  Span<Search> search[kMostSearches];  ///< [pairs computed by this program]

  SCREE_HD const Search& operator[](Index place) const {
    const int store = store_of(place);
    return search[store][place - begin[store]];
  }
};

/// What a pair has instead of a place until it is computed.
inline constexpr Index kNoPlace = -1;

/// Near pairs and what was found of them.
struct PairNotes {
  Span<std::uint64_t> key;      ///< [pairs] bodies, ascending: see make_key()
  Span<Index> count;            ///< [pairs] contacts
  Span<PairFeatures> features;  ///< [pairs] of these
  Span<Index> place;            ///< [pairs] where they are stored, see StorePlaces
  Span<SameList> same;          ///< [pairs] envelopes for which that holds

  /// Number of a pair; -1: it is none of these.
  SCREE_HD Index find(std::uint64_t wanted) const {
    const auto end = static_cast<Index>(key.size);
    const Index q = first_not_below(Span<const std::uint64_t>(key), 0, end, wanted);
    return q < end && key[q] == wanted ? q : -1;
  }
  /// @param found  contacts, stored at the place
  SCREE_HD void set(Index q, Index found, const PairFeatures& of_contacts, Index at,
                    const SameList& holds_for) const {
    count[q] = found;
    features[q] = of_contacts;
    place[q] = at;
    same[q] = holds_for;
  }
};

/// A near pair as its pair function takes it.
template <class P, class Real>
struct LoadedPair {
  using Test = ContactTest<ShapeMix::any, Real>;

  BodySample body, other;
  double h;      ///< [s]
  double reach;  ///< gap up to which contacts are listed [m]
  double wider;  ///< the same of the search, so that its result holds for wider margins [m]
  double most;   ///< bodies that are farther apart have no contact [m]
  OrderedPair<P> order;

  SCREE_HD LoadedPair(const Test& test, std::uint64_t key)
      : LoadedPair(test, contact_body(key), static_cast<Index>(key_element(key))) {}

  /// Whether a contact is listed, and what that tells of other envelopes.
  SCREE_HD auto listed(SameList& same) const {
    return [this, &same](const ContactGeometry& found) {
      const ContactGeometry g = order.in_memory(found);
      const double speed = separation_speed(g, body.motion, other.motion);
      return same.lists(needed_envelope(g.gap, speed, h), reach);
    };
  }
  /// To begin with: nothing is decided.
  SCREE_HD SameList same() const {
    SameList s;
    s.to = wider;
    return s;
  }

 private:
  SCREE_HD LoadedPair(const Test& test, Index i, Index j)
      : body(test.load(i)),
        other(test.load(j)),
        h(test.range.h),
        reach(test.reach(i, body, j, other)),
        wider(reach + kSlack * test.range.envelope),
        most(wider + h * most_speed(body, other.motion, other.radius)),
        order(body, other, minimum_image(other.position - body.position, test.range.period),
              PairList::is_reversed(body.kind, other.kind), test.range.h) {}
};

/// The pairs that a program computes, and where it stores their contacts.
template <class P, class Real>
struct ComputedPairs {
  static_assert(P::kFeatureBits <= PairFeatures::kBits);

  ContactTest<ShapeMix::any, Real> test;
  Span<const Index> pair;  ///< of this program
  PairNotes notes;
  Index place;                       ///< of the first pair
  Span<FoundContact<Real>> contact;  ///< [pairs of this program][kSlots] out

  SCREE_HD LoadedPair<P, Real> load(Index k) const { return {test, notes.key[pair[k]]}; }
  /// Contact c of pair k.
  SCREE_HD void store(Index k, Index c, const LoadedPair<P, Real>& p,
                      const ContactGeometry& found) const {
    const Offset slot = static_cast<Offset>(k) * ContactStores<Real>::kSlots + c;
    contact[slot] = FoundContact<Real>(p.order.in_memory(found), p.other.radius < p.body.radius);
  }
  /// All is found of pair k.
  SCREE_HD void note(Index k, Index count, const PairFeatures& features,
                     const SameList& same) const {
    notes.set(pair[k], count, features, place + k, same);
  }
};

/// Finds the contacts of the pairs of one program: once, so that what rounding decides about features
/// holds for all that follows.
template <class P, class Real>
struct FindPairContacts {
  static constexpr const char* name = "find_pair_contacts";
  static constexpr int kBlockThreads = 64;  // pairs take different times, and there may be few
  ComputedPairs<P, Real> pairs;

  SCREE_HD void operator()(Index k) const {
    const LoadedPair<P, Real> p = pairs.load(k);
    SameList same = p.same();
    Index count = 0;
    PairFeatures features;
    if constexpr (P::kFeatureBits == 0) {
      const ContactGeometry g = pair_contact<P>(p.order.a, p.order.b, p.order.d, 0);
      if (p.listed(same)(g)) pairs.store(k, count++, p, g);
    } else {
      const Manifold m = P::manifold(p.order.a, p.order.b, p.order.d, p.most, p.listed(same));
      for (; count < m.count; ++count) {
        features.set(count, m.feature[count]);
        pairs.store(k, count, p, m.contact[count]);
      }
    }
    pairs.note(k, count, features, same);
  }
};

/// Programs in parts have their stack in memory: with six blocks of 64 threads on a multiprocessor one waits while another runs,
/// and with more their stacks put each other out of the nearest cache.
inline constexpr int kPartBlocks = 6;

/// The first part of a program in parts: how the bodies lie, unless a search before told. It takes the pairs that are too far
/// apart out, and says which need the second part, and which of them for longer.
template <InParts P, class Real>
struct SearchPairs {
  static constexpr const char* name = "search_pairs";
  static constexpr int kBlockThreads = 64;
  static constexpr int kLeastBlocks = kPartBlocks;
  ComputedPairs<P, Real> pairs;
  SearchStores<typename P::Search> before;
  Span<typename P::Search> search;  ///< [pairs of this program] out
  Span<Index> is_near;              ///< [pairs of this program] out: 1 or 0
  Span<Index> is_open;  ///< the same, of programs that finish searches: but for those that are deep
  Span<Index> is_deep;  ///< the same

  SCREE_HD void operator()(Index k) const {
    const LoadedPair<P, Real> p = pairs.load(k);
    const Index old = pairs.notes.place[pairs.pair[k]];
    const auto found = P::search(p.order.a, p.order.b, p.order.d, p.most,
                                 old == kNoPlace ? nullptr : &before[old]);
    search[k] = found;
    if constexpr (Finishes<P>) {
      is_deep[k] = found.is_deep() ? 1 : 0;
      is_open[k] = found.is_open() && !found.is_deep() ? 1 : 0;
    }
    is_near[k] = found.is_beyond() ? 0 : 1;
    if (found.is_beyond()) pairs.note(k, 0, {}, p.same());
  }
};

/// The second part, of those that need it. Those that take long lie beside each other.
template <Finishes P, class Real>
struct FinishPairs {
  static constexpr const char* name = "finish_pairs";
  static constexpr int kBlockThreads = 64;
  static constexpr int kLeastBlocks = kPartBlocks;
  ComputedPairs<P, Real> pairs;
  FlaggedLists open;
  Span<typename P::Search> search;  ///< in and out
  Span<Index> may_pass;             ///< [pairs of this program] out, of these: 1 or 0

  SCREE_HD void operator()(Index n) const {
    const Index k = open.find(n);
    if (k < 0) return;
    const LoadedPair<P, Real> p = pairs.load(k);
    P::finish(p.order.a, p.order.b, p.order.d, search[k]);
    may_pass[k] = search[k].may_pass ? 1 : 0;
  }
};

/// Finds how bodies pass each other, of pairs that may.
template <Finishes P, class Real>
struct PassPairs {
  static constexpr const char* name = "pass_pairs";
  static constexpr int kBlockThreads = 64;
  static constexpr int kLeastBlocks = kPartBlocks;
  ComputedPairs<P, Real> pairs;
  FlaggedList passing;
  Span<typename P::Search> search;  ///< in and out

  SCREE_HD void operator()(Index n) const {
    if (!passing.has(n)) return;
    const Index k = passing.element[n];
    const LoadedPair<P, Real> p = pairs.load(k);
    P::pass(p.order.a, p.order.b, p.order.d, search[k]);
  }
};

/// Takes pairs that meet in a face out of those that are not too far apart: the third part takes longer for them.
template <Finishes P>
struct SplitByFacets {
  static constexpr const char* name = "split_by_facets";
  Span<const typename P::Search> search;
  Span<Index> is_near;    ///< in and out
  Span<Index> has_facet;  ///< out

  SCREE_HD void operator()(Index k) const {
    has_facet[k] = is_near[k] != 0 && search[k].has_facet ? 1 : 0;
    if (has_facet[k] != 0) is_near[k] = 0;
  }
};

/// The third part: contacts of the pairs that are not too far apart. Those that take long lie beside each other.
template <InParts P, class Real>
struct FindSearchedContacts {
  static constexpr const char* name = "find_searched_contacts";
  static constexpr int kBlockThreads = 64;
  static constexpr int kLeastBlocks = kPartBlocks;
  ComputedPairs<P, Real> pairs;
  FlaggedLists near;
  Span<const typename P::Search> search;

  SCREE_HD void operator()(Index n) const {
    const Index k = near.find(n);
    if (k < 0) return;
    const LoadedPair<P, Real> p = pairs.load(k);
    SameList same = p.same();
    Index count = 0;
    PairFeatures features;
    P::contacts(p.order.a, p.order.b, p.order.d, search[k], p.most, p.listed(same),
                [&](std::uint32_t feature, const ContactGeometry& g) {
                  features.set(count, feature);
                  pairs.store(k, count++, p, g);
                });
    pairs.note(k, count, features, same);
  }
};

}  // namespace scree
