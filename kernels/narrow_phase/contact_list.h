#pragma once
// Element programs that list contacts: which candidates and planes a body touches, their keys in
// order, and their geometry. Contacts with solid walls have passes of their own, see solid_contacts.h.

#include "kernels/broad_phase/pair_candidates.h"
#include "kernels/contact/contact_view.h"
#include "kernels/math/periodic.h"
#include "kernels/narrow_phase/wall_contacts.h"

namespace scree {

/// Gap up to which contacts of body a with walls are listed [m].
SCREE_HD inline double wall_envelope(const ContactRange& range, Index a, double radius) {
  return range.envelope + range.margin_of(a) + range.fall_of(radius);
}
SCREE_HD inline double wall_envelope(const ContactRange& range, Index a, const BodySample& body) {
  return wall_envelope(range, a, body.radius);
}

/// Decides which candidates are contacts, exactly: the list of candidates only says
/// which not to test.
template <ShapeMix kMix, class Real>
struct ContactTest {
  BodyView<Real> bodies;
  ShapeSet<Real> shapes;
  CandidateView candidates;
  WallView<Real> walls;
  ContactRange range;
  ContactKeys keys;
  bool has_parts = false;  ///< `bodies` are parts; those of one body have its id, and never meet

  SCREE_HD BodySample load(Index a) const { return load_body<kMix>(bodies, shapes, range, a); }

  /// Gap up to which contacts of the two bodies are listed [m].
  SCREE_HD double envelope(Index a, Index j) const {
    return range.envelope + range.margin_of(a) + range.margin_of(j);
  }

  /// What that has to be for spheres to be in contact [m]. Below the envelope without
  /// margins any value will do.
  SCREE_HD double needed(const BodySample& body, Index j) const {
    const Vec3d d = minimum_image(bodies.position[j] - body.position, range.period);
    const double distance = norm(d);
    const auto radius_j = static_cast<double>(bodies.radius[j]);
    const double gap = distance - (body.radius + radius_j);
    if (gap <= range.envelope) return gap;
    const Vec3d u = course_velocity(bodies, range, j) - body.motion.linear;
    return needed_envelope(gap, dot(u, d) / distance, range.h) - falls(body.radius, radius_j);
  }

  /// The same with how much nearer gravity may bring them in the step [m].
  SCREE_HD double reach(Index a, const BodySample& body, Index j, const BodySample& other) const {
    return envelope(a, j) + falls(body.radius, other.radius);
  }

  SCREE_HD double reach(Index a, Index j) const {
    return envelope(a, j) + falls(bodies.radius[a], bodies.radius[j]);
  }

  /// How far two bodies may come nearer because gravity acts on one of them only [m].
  SCREE_HD double falls(double radius_a, double radius_b) const {
    return range.fall > 0 ? range.fall_of(radius_a) + range.fall_of(radius_b) : 0;
  }

  /// Whether body a may have contacts with planes: it takes much less than to load what its shape is.
  SCREE_HD bool is_near_planes(Index a) const {
    const float inflated = inflated_radius(bodies, range, a);
    const double envelope = wall_envelope(range, a, static_cast<double>(bodies.radius[a]));
    for (Index p = 0; p < static_cast<Index>(walls.planes.size); ++p) {
      if (is_near_plane(walls.planes[p], bodies.position[a], envelope, inflated)) return true;
    }
    return false;
  }

  /// Calls emit(element) for each contact of body a with planes, elements ascending.
  template <class Emit>
  SCREE_HD void with_planes(Index a, const BodySample& body, Emit&& emit) const {
    const float inflated = inflated_radius(bodies, range, a);
    if (!(inflated > 0)) return;
    visit_planes<kMix>(walls.planes, range, keys, body, wall_envelope(range, a, body), inflated,
                       emit);
  }
};

/// The envelope that a contact takes, rounded: 4 bytes a candidate are enough, since what is not
/// sure is tested again.
SCREE_HD inline float note_needed(double needed) { return static_cast<float>(needed); }

/// Whether the note tells if the envelope is enough: not when rounding might decide,
/// nor when there is no note.
SCREE_HD inline bool note_decides(float note, double envelope) {
  const double noted = note;
  return std::abs(noted - envelope) > 1.2e-7 * std::abs(noted);
}

/// Counts the contacts of each piece of the candidates, those with planes in the last piece of a
/// body, and notes which candidates they are, and what envelopes it would take. Spheres only.
/// Bytes per piece, besides neighbors from the caches: 8 and 4 per candidate, 40 of its body; 8
/// written, and 4 per candidate.
template <ShapeMix kMix, class Real>
struct CountContacts {
  static constexpr const char* name = "count_contacts";
  static constexpr int kLeastBlocks = 4;
  ContactTest<kMix, Real> test;
  Span<Index> count;             ///< [piece count] out
  Span<std::uint32_t> touching;  ///< [piece count] out: bit k, the k-th candidate is in contact
  Span<float> needed;  ///< [candidates] out: for RecountContacts [m]; or empty: not asked for

  SCREE_HD void operator()(Index p) const {
    const CandidateView& list = test.candidates;
    const Index a = list.body[p];
    const BodySample body = test.load(a);
    const Index first = list.begin[p], end = list.begin[p + 1];
    std::uint32_t found = 0;
    Index n = 0;
    const auto add = [&](Index k) {
      found |= 1u << (k - first);
      ++n;
    };
    for (Index k = first; k < end; ++k) {
      const Index j = list.other[k];
      const double least = test.needed(body, j);
      if (!needed.empty()) needed[k] = note_needed(least);
      if (least <= test.envelope(a, j)) add(k);
    }
    if (list.is_last_of_body(p)) test.with_planes(a, body, [&](std::uint32_t) { ++n; });
    count[p] = n;
    touching[p] = found;
  }
};

/// The same again for other margins, when bodies are where they were, and the list is the same but
/// for pairs that were added to it. Spheres only. Bytes per piece, besides margins from the caches:
/// 8 and 8 per candidate, 40 of its body; 8 written.
template <ShapeMix kMix, class Real>
struct RecountContacts {
  static constexpr const char* name = "recount_contacts";
  static constexpr int kLeastBlocks = 4;
  ContactTest<kMix, Real> test;
  Span<float> needed;  ///< [candidates] by CountContacts; in: kNotNoted, out: noted, where added
  Span<Index> count;
  Span<std::uint32_t> touching;

  SCREE_HD void operator()(Index p) const {
    const CandidateView& list = test.candidates;
    const Index a = list.body[p];
    const Index first = list.begin[p], end = list.begin[p + 1];
    std::uint32_t found = 0;
    Index n = 0;
    for (Index k = first; k < end; ++k) {
      if (!is_contact(a, k)) continue;
      found |= 1u << (k - first);
      ++n;
    }
    if (list.is_last_of_body(p)) {
      test.with_planes(a, test.load(a), [&](std::uint32_t) { ++n; });
    }
    count[p] = n;
    touching[p] = found;
  }

 private:
  SCREE_HD bool is_contact(Index a, Index k) const {
    const Index j = test.candidates.other[k];
    const double envelope = test.envelope(a, j);
    const float note = needed[k];
    if (note_decides(note, envelope)) return static_cast<double>(note) < envelope;
    const double least = test.needed(test.load(a), j);
    needed[k] = note_needed(least);
    return least <= envelope;
  }
};

/// Writes the keys of the contacts in ascending order. Spheres only.
/// Bytes per piece: 24 read, per contact 4 read and 8 written; bodies at walls are tested again.
template <ShapeMix kMix, class Real>
struct WriteContactKeys {
  static constexpr const char* name = "write_contact_keys";
  static constexpr int kLeastBlocks = 5;
  ContactTest<kMix, Real> test;
  Span<const Offset> begin;  ///< [piece count + 1] scan of the counts
  Span<const std::uint32_t> touching;
  Span<std::uint64_t> key;  ///< [contact count] out

  SCREE_HD void operator()(Index p) const {
    Offset next = begin[p];
    const Offset end = begin[p + 1];
    if (next == end) return;
    const CandidateView& list = test.candidates;
    const Index a = list.body[p];
    const std::uint32_t found = touching[p];
    for (Index k = 0; k < kPieceLength && found >> k != 0; ++k) {
      if ((found >> k & 1) == 0) continue;
      const Index j = list.other[list.begin[p] + k];
      key[next++] = make_key(a, test.keys.body_element(j, 0));
    }
    if (next == end) return;
    // What is left are planes, whose elements are above those of all bodies, or solid walls.
    test.with_planes(a, test.load(a),
                     [&](std::uint32_t element) { key[next++] = make_key(a, element); });
  }
};

/// Where contacts are stored.
template <class Real>
struct ContactArrays : FoundFields<InSpans<Real>> {
  Index radial_count = 0;  ///< the first ones have no stored arms

  SCREE_HD void store(Index c, Index a, Index b, const ContactGeometry& g) const {
    store(c, a, b, Vec3<Real>(g.normal), static_cast<Real>(g.gap), Vec3<Real>(g.arm_a),
          Vec3<Real>(g.arm_b));
  }
  SCREE_HD void store(Index c, Index a, Index b, const Vec3<Real>& n, Real g,
                      const Vec3<Real>& from_a, const Vec3<Real>& from_b) const {
    this->body_a[c] = a;
    this->body_b[c] = b;
    this->normal[c] = n;
    this->gap[c] = g;
    if (c >= radial_count) {
      this->arm_a[c - radial_count] = from_a;
      this->arm_b[c - radial_count] = from_b;
    }
  }
};

/// The contact of two spheres.
/// @tparam kPasses  whether they may pass each other within the step, see spheres_on_way()
template <bool kPasses>
SCREE_HD ContactGeometry two_spheres(const BodySample& a, const BodySample& b,
                                     const ContactRange& range) {
  const Vec3d d = minimum_image(b.position - a.position, range.period);
  ContactGeometry g = sphere_sphere(d, a.radius, b.radius);
  if (kPasses && g.gap > 0) {
    const Vec3d way = range.h * (b.motion.linear - a.motion.linear);
    g = spheres_on_way(g, d, way, a.radius, b.radius);
  }
  return g;
}

/// Turns keys of contacts with bodies and planes into contacts: bodies, normal, gap, lever arms. Spheres only.
/// Bytes per contact (float, radial), besides bodies from the caches: 8 read, 24 written.
/// @tparam kPasses  see two_spheres(): a program of its own, since that takes half as many registers again
template <ShapeMix kMix, bool kPasses, class Real>
struct FillContacts {
  static constexpr const char* name = "fill_contacts";
  static constexpr int kLeastBlocks = kPasses ? 3 : 4;
  BodyView<Real> bodies;
  ShapeSet<Real> shapes;
  Span<const WallPlane> planes;
  ContactRange range;
  ContactKeys keys;
  Span<const std::uint64_t> key;
  ContactArrays<Real> out;

  SCREE_HD void operator()(Index c) const {
    const Index a = contact_body(key[c]);
    const std::uint32_t element = key_element(key[c]);
    if (kMix != ShapeMix::spheres_and_planes && element >= keys.solid_begin) return;
    const BodySample body = load_body<kMix>(bodies, shapes, range, a);
    ContactGeometry g;
    Index b;
    if (keys.is_body(element)) {
      b = keys.body(element);
      g = two_spheres<kPasses>(body, load_body<kMix>(bodies, shapes, range, b), range);
    } else {
      g = plane_contact<kMix>(planes, keys, body, element, b);
    }
    out.store(c, a, b, g);
  }
};

}  // namespace scree
