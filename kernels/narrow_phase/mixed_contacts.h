#pragma once
// Element programs of contacts between bodies of any shapes, in stages: which candidates are near enough to be computed;
// the contacts of each such pair, once, by a program of its pair function; their keys; the contacts. Two
// spheres take so little that they are computed wherever they are needed.

#include "kernels/narrow_phase/contact_list.h"

namespace scree {

/// Pairs of bodies, not two spheres, that are near enough to be computed. Those of a piece of the candidates lie beside
/// each other, in the order of these.
struct NearPairs {
  Span<const Offset> begin;           ///< [piece count + 1] first pair of each piece
  Span<const std::uint32_t> is_near;  ///< [piece count] bit k: the k-th candidate is one
  Span<const std::uint32_t>
      touching;  ///< [piece count] bit k: the k-th candidate is a contact of two spheres
};

/// What is stored of a contact until all of them are counted.
template <class Real>
struct FoundContact {
  std::uint32_t feature = 0;
  Real gap = 0;
  Vec3<Real> normal, arm_a, arm_b;
};

/// Contacts that were found of near pairs.
template <class Real>
struct PairContacts {
  static constexpr int kSlots = Manifold::kMaxContacts;
  Span<Index> count;                 ///< [pairs]
  Span<FoundContact<Real>> contact;  ///< [pairs][kSlots]
};

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
      } else if (norm(d) <= kRoom * (body.radius + other.radius) + reach +
                                test.range.h * most_speed(body, other.motion, other.radius)) {
        near |= bit;
        ++n;
      }
    }
    count[p] = n;
    is_near[p] = near;
    touching[p] = touch;
  }

 private:
  /// Bounding radii may have been rounded down.
  static constexpr double kRoom = 1 + 1e-6;
  SCREE_HD static bool is_sphere(const BodySample& body) {
    return body.kind == shapes::Sphere::kind;
  }
};

/// Lists the near pairs, and the pair function of each.
template <class Real>
struct ListNearPairs {
  static constexpr const char* name = "list_near_pairs";
  ContactTest<ShapeMix::any, Real> test;
  NearPairs pairs;
  Span<Index> body_a;
  Span<Index> body_b;
  Span<std::uint64_t> function;  ///< out: its number in PairList
  Span<Index> pair;              ///< out: the pairs themselves, to be sorted by that

  SCREE_HD void operator()(Index p) const {
    const CandidateView& list = test.candidates;
    const Index a = list.body[p];
    Offset q = pairs.begin[p];
    const std::uint32_t is_near = pairs.is_near[p];
    for (Index k = 0; k < kPieceLength && is_near >> k != 0; ++k) {
      if ((is_near >> k & 1) == 0) continue;
      const Index j = list.other[list.begin[p] + k];
      body_a[q] = a;
      body_b[q] = j;
      pair[q] = static_cast<Index>(q);
      function[q] = static_cast<std::uint64_t>(PairList::number_of(kind_of(a), kind_of(j)));
      ++q;
    }
  }

 private:
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

/// Finds the contacts of the pairs of one pair function: once, so that what rounding decides about features
/// holds for all that follows.
/// @tparam P  what runs the pair function, see ProgramOf
template <class P, class Real>
struct FindPairContacts {
  static constexpr const char* name = "find_pair_contacts";
  static constexpr int kBlockThreads = 64;  // pairs take different times, and there may be few
  ContactTest<ShapeMix::any, Real> test;
  ShapeKind first;  ///< of the shapes of the pair function
  Span<const Index> body_a;
  Span<const Index> body_b;
  Span<const Index> pair;  ///< of this function
  PairContacts<Real> found;

  SCREE_HD void operator()(Index k) const {
    const Index q = pair[k], i = body_a[q], j = body_b[q];
    const BodySample body = test.load(i), other = test.load(j);
    const Vec3d d = minimum_image(other.position - body.position, test.range.period);
    const double reach = test.reach(i, body, j, other), h = test.range.h;
    const OrderedPair<P> p(body, other, d, body.kind != first);
    const auto listed = [&](const ContactGeometry& found_one) {
      const ContactGeometry g = p.in_memory(found_one);
      return is_listed(g.gap, separation_speed(g, body.motion, other.motion), reach, h);
    };
    const double most = reach + h * most_speed(body, other.motion, other.radius);
    const Offset slot = static_cast<Offset>(q) * PairContacts<Real>::kSlots;
    if constexpr (P::kFeatureBits == 0) {
      const ContactGeometry g = P::contact(p.a, p.b, p.d, 0);
      const bool is_one = listed(g);
      found.count[q] = is_one ? 1 : 0;
      if (is_one) store(slot, 0, p.in_memory(g));
    } else {
      const Manifold m = P::manifold(p.a, p.b, p.d, most, listed);
      found.count[q] = m.count;
      for (int c = 0; c < m.count; ++c) store(slot + c, m.feature[c], p.in_memory(m.contact[c]));
    }
  }

 private:
  SCREE_HD void store(Offset slot, std::uint32_t feature, const ContactGeometry& g) const {
    found.contact[slot] = {feature, static_cast<Real>(g.gap), Vec3<Real>(g.normal),
                           Vec3<Real>(g.arm_a), Vec3<Real>(g.arm_b)};
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
      test.with_planes(a, test.load(a), [&](std::uint32_t) { ++n; });
    }
    count[p] = n;
  }
};

/// Writes the keys of the contacts in ascending order, and where each is stored.
/// Bytes per piece: 24 read and 4 per near pair, per contact 4 read and 12 written; bodies at walls are tested again.
template <class Real>
struct WriteMixedKeys {
  static constexpr const char* name = "write_mixed_keys";
  ContactTest<ShapeMix::any, Real> test;
  NearPairs pairs;
  PairContacts<Real> found;
  Span<const Offset> begin;  ///< [piece count + 1] scan of the counts
  Span<std::uint64_t> key;   ///< [contact count] out
  Span<Offset> slot;         ///< [contact count] out: in `found`, or kNotStored

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
          const Offset first = q * PairContacts<Real>::kSlots;
          for (Index c = 0; c < found.count[q]; ++c)
            write(test.keys.body_element(j, found.contact[first + c].feature), first + c);
        });
    // Planes come after them: their elements are above those of all bodies. Then solid walls, which others write.
    if (list.is_last_of_body(p)) {
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
/// Bytes per contact (float), besides bodies from the caches: 16 and 44 read, 48 written.
/// @tparam kPasses  see FillContacts
template <bool kPasses, class Real>
struct FillMixedContacts {
  static constexpr const char* name = "fill_mixed_contacts";
  static constexpr int kLeastBlocks = kPasses ? 2 : 3;
  ContactTest<ShapeMix::any, Real> test;
  Span<const std::uint64_t> key;
  Span<const Offset> slot;
  Span<const FoundContact<Real>> found;
  ContactArrays<Real> out;

  SCREE_HD void operator()(Index c) const {
    const Index a = contact_body(key[c]);
    const std::uint32_t element = key_element(key[c]);
    const ContactKeys& keys = test.keys;
    if (element >= keys.solid_begin) return;
    if (slot[c] != kNotStored) {
      const FoundContact<Real> f = found[slot[c]];
      out.store(c, a, keys.body(element), f.normal, f.gap, f.arm_a, f.arm_b);
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
