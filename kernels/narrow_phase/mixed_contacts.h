#pragma once
// Element programs of contacts between bodies of any shapes, in stages: which candidates are near enough to be computed;
// the contacts of each such pair, once, by a program of its pair function; their keys; the contacts. Where the search is
// repeated within a step, for wider margins, pairs keep what was found of them if it holds. Two spheres take so little that
// they are computed wherever they are needed.

#include "kernels/narrow_phase/near_pairs.h"

namespace scree {

/// Where a contact is not stored, since it is computed again.
inline constexpr Offset kNotStored = -1;

/// Decides which candidates are near pairs, and which are contacts of two spheres.
/// Bytes per piece, besides neighbors from the caches: 8 and 4 per candidate, 80 of its body; 12 written.
template <class Real>
struct FlagNearPairs {
  static constexpr const char* name = "flag_near_pairs";
  static constexpr int kLeastBlocks = 3;
  ContactTest<ShapeMix::any, Real> test;
  Span<Index> count;  ///< [piece count] out: near pairs
  Span<std::uint32_t> is_near;
  Span<std::uint32_t> touching;

  SCREE_HD void operator()(Index p) const {
    const CandidateView& list = test.candidates;
    const Index a = list.body[p];
    const Index first = list.begin[p], end = list.begin[p + 1];
    const BodySample body = test.load(a);
    std::uint32_t near = 0, touch = 0;
    Index n = 0;
    for (Index k = first; k < end; ++k) {
      const Index j = list.other[k];
      if (test.has_parts && test.bodies.id[a] == test.bodies.id[j]) continue;
      const BodySample other = test.load(j);
      const Vec3d d = minimum_image(other.position - body.position, test.range.period);
      const double reach = test.reach(a, body, j, other);
      const std::uint32_t bit = 1u << (k - first);
      if (is_sphere(body) && is_sphere(other)) {
        const ContactGeometry g = sphere_sphere(d, body.radius, other.radius);
        if (is_listed(g.gap, separation_speed(g, body.motion, other.motion), reach, test.range.h))
          touch |= bit;
      } else if (is_near_pair(
                     body, other, d,
                     reach + test.range.h * most_speed(body, other.motion, other.radius))) {
        near |= bit;
        ++n;
      }
    }
    count[p] = n;
    is_near[p] = near;
    touching[p] = touch;
  }

 private:
  /// Bounding radii and boxes may have been rounded down.
  static constexpr double kRoom = 1e-6;
  /// Whether spheres and boxes about two bodies are no farther apart than that.
  SCREE_HD static bool is_near_pair(const BodySample& a, const BodySample& b, const Vec3d& d,
                                    double most) {
    const double radii = a.radius + b.radius;
    return norm(d) <= radii + kRoom * radii + most &&
           !are_apart({{box_about(a), box_about(b)}, d}, most + kRoom * radii);
  }
  SCREE_HD static BoxAxes box_about(const BodySample& body) {
    if (is_sphere(body)) return {body.orientation, {body.radius, body.radius, body.radius}};
    const double more = body.rounded.reach();
    return {body.orientation, body.half_extents + Vec3d{more, more, more}};
  }
  SCREE_HD static bool is_sphere(const BodySample& body) {
    return body.kind == shapes::Sphere::kind;
  }
};

/// Lists the near pairs, and the pair function of each that has to be computed: not where what the search before found holds.
template <class Real>
struct ListNearPairs {
  static constexpr const char* name = "list_near_pairs";
  ContactTest<ShapeMix::any, Real> test;
  NearPairs pairs;
  PairNotes before;              ///< of that search; without pairs: there was none
  PairNotes notes;               ///< out
  Span<std::uint64_t> function;  ///< out: its number in PairList; kBodyPairs: none is needed
  Span<Index> pair;              ///< out: the pairs themselves, to be sorted by that

  SCREE_HD void operator()(Index p) const {
    const CandidateView& list = test.candidates;
    const Index a = list.body[p];
    Offset q = pairs.begin[p];
    const std::uint32_t is_near = pairs.is_near[p];
    for (Index k = 0; k < kPieceLength && is_near >> k != 0; ++k) {
      if ((is_near >> k & 1) == 0) continue;
      const Index j = list.other[list.begin[p] + k];
      notes.key[q] = make_key(a, static_cast<std::uint32_t>(j));
      pair[q] = static_cast<Index>(q);
      function[q] = static_cast<std::uint64_t>(
          is_kept(q, a, j) ? PairList::kBodyPairs : PairList::number_of(kind_of(a), kind_of(j)));
      ++q;
    }
  }

 private:
  SCREE_HD bool is_kept(Offset q, Index a, Index j) const {
    const Index old = before.find(notes.key[q]);
    if (old < 0) {
      notes.set(static_cast<Index>(q), 0, {}, kNoPlace, {});
      return false;
    }
    // Its place is kept also where it must be computed again: what the search before told of it may hold.
    notes.set(static_cast<Index>(q), before.count[old], before.features[old], before.place[old],
              before.same[old]);
    return before.same[old].holds(test.reach(a, j));
  }
  SCREE_HD ShapeKind kind_of(Index i) const {
    const Index shape = test.bodies.shape[i];
    return shape < 0 ? shapes::Sphere::kind : test.shapes.records[shape].kind;
  }
};

/// Where the pairs of each pair function begin in their sorted list.
struct FindFunctionRanges {
  static constexpr const char* name = "find_function_ranges";
  Span<const std::uint64_t> function;  ///< ascending
  Span<Index> begin;                   ///< out

  SCREE_HD void operator()(Index f) const {
    begin[f] = first_not_below(function, 0, static_cast<Index>(function.size),
                               static_cast<std::uint64_t>(f));
  }
};

/// Calls on_spheres(j) and on_pair(q, j) for the candidates of a piece that are contacts of two spheres and near pairs,
/// in their order.
template <class OnSpheres, class OnPair>
SCREE_HD void visit_near(const CandidateView& list, const NearPairs& pairs, Index p,
                         OnSpheres&& on_spheres, OnPair&& on_pair) {
  Offset q = pairs.begin[p];
  const std::uint32_t touching = pairs.touching[p], all = touching | pairs.is_near[p];
  for (Index k = 0; k < kPieceLength && all >> k != 0; ++k) {
    if ((all >> k & 1) == 0) continue;
    const Index j = list.other[list.begin[p] + k];
    if ((touching >> k & 1) != 0) {
      on_spheres(j);
    } else {
      on_pair(q++, j);
    }
  }
}

/// Counts the contacts of each piece, those with planes in the last piece of a body.
/// Bytes per piece: 24 read and 4 per near pair, 80 of its body; 4 written.
template <class Real>
struct CountMixedContacts {
  static constexpr const char* name = "count_mixed_contacts";
  static constexpr int kLeastBlocks = 2;
  ContactTest<ShapeMix::any, Real> test;
  NearPairs pairs;
  Span<const Index> found;  ///< [pairs] contacts of each
  Span<Index> count;        ///< [piece count] out

  SCREE_HD void operator()(Index p) const {
    Index n = 0;
    for (std::uint32_t left = pairs.touching[p]; left != 0; left &= left - 1) ++n;
    for (Offset q = pairs.begin[p]; q < pairs.begin[p + 1]; ++q) n += found[q];
    const CandidateView& list = test.candidates;
    if (list.is_last_of_body(p)) {
      const Index a = list.body[p];
      if (test.is_near_planes(a)) test.with_planes(a, test.load(a), [&](std::uint32_t) { ++n; });
    }
    count[p] = n;
  }
};

/// Writes the keys of the contacts in ascending order, and where each is stored.
/// Bytes per piece: 24 read and 16 per near pair, per contact 12 written; bodies at walls are tested again.
template <class Real>
struct WriteMixedKeys {
  static constexpr const char* name = "write_mixed_keys";
  static constexpr int kLeastBlocks = 2;
  ContactTest<ShapeMix::any, Real> test;
  NearPairs pairs;
  PairNotes notes;
  Span<const Offset> begin;  ///< [piece count + 1] scan of the counts
  Span<std::uint64_t> key;   ///< [contact count] out
  Span<Offset> slot;         ///< [contact count] out: place and number in the stores, or kNotStored

  SCREE_HD void operator()(Index p) const {
    Offset next = begin[p];
    const Offset end = begin[p + 1];
    if (next == end) return;
    const CandidateView& list = test.candidates;
    const Index a = list.body[p];
    const auto write = [&](std::uint32_t element, Offset stored) {
      key[next] = make_key(a, element);
      slot[next] = stored;
      ++next;
    };
    visit_near(
        list, pairs, p, [&](Index j) { write(test.keys.body_element(j, 0), kNotStored); },
        [&](Offset q, Index j) {
          const Index count = notes.count[q];
          if (count == 0) return;
          const PairFeatures features = notes.features[q];
          const Offset first = static_cast<Offset>(notes.place[q]) * ContactStores<Real>::kSlots;
          for (Index c = 0; c < count; ++c)
            write(test.keys.body_element(j, features[c]), first + c);
        });
    // Planes come after them: their elements are above those of all bodies. Then solid walls, which others write.
    if (list.is_last_of_body(p) && test.is_near_planes(a)) {
      test.with_planes(a, test.load(a), [&](std::uint32_t element) { write(element, kNotStored); });
    }
    for (; next < end; ++next) slot[next] = kNotStored;
  }
};

/// Brings what goes with keys into the order that GroupKeys gives these.
struct GroupSlots {
  static constexpr const char* name = "group_slots";
  Span<const Offset> slot;
  Span<const Index> flag;
  Span<const Offset> before;
  Offset radial_count;
  Span<Offset> grouped;

  SCREE_HD void operator()(Index c) const {
    grouped[flag[c] != 0 ? radial_count + before[c] : c - before[c]] = slot[c];
  }
};

/// Turns keys of contacts with bodies and planes into contacts.
/// Bytes per contact (float), besides bodies from the caches: 16 and 32 read, 48 written.
/// @tparam kPasses  see FillContacts
template <bool kPasses, class Real>
struct FillMixedContacts {
  static constexpr const char* name = "fill_mixed_contacts";
  static constexpr int kLeastBlocks = kPasses ? 2 : 3;
  ContactTest<ShapeMix::any, Real> test;
  Span<const std::uint64_t> key;
  Span<const Offset> slot;
  ContactStores<Real> stores;
  ContactArrays<Real> out;

  SCREE_HD void operator()(Index c) const {
    const Index a = contact_body(key[c]);
    const std::uint32_t element = key_element(key[c]);
    const ContactKeys& keys = test.keys;
    if (element >= keys.solid_begin) return;
    if (slot[c] != kNotStored) {
      constexpr Index kSlots = ContactStores<Real>::kSlots;
      const auto place = static_cast<Index>(slot[c] / kSlots);
      const int store = stores.store_of(place);
      const FoundContact<Real> f =
          stores.contact[store][stores.slot(store, place) + slot[c] % kSlots];
      const Index j = keys.body(element);
      const Vec3d d =
          minimum_image(test.bodies.position[j] - test.bodies.position[a], test.range.period);
      out.store(c, a, j, f.normal, f.gap, f.arm_a(d), f.arm_b(d));
      return;
    }
    const BodySample body = test.load(a);
    ContactGeometry g;
    Index b;
    if (keys.is_body(element)) {
      b = keys.body(element);
      g = two_spheres<kPasses>(body, test.load(b), test.range);
    } else {
      g = plane_contact<ShapeMix::any>(test.walls.planes, keys, body, element, b);
    }
    out.store(c, a, b, g);
  }
};

}  // namespace scree
