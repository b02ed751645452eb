#pragma once
// Element programs of contacts with solid walls. Few bodies are near one, and those that are take long, so they have
// passes of their own, which find contacts once and note what others need of them.

#include "kernels/backend/ordered_lists.h"
#include "kernels/bodies/parts.h"
#include "kernels/narrow_phase/contact_list.h"
#include "kernels/narrow_phase/list_flagged.h"
#include "kernels/narrow_phase/solid_walls.h"

namespace scree {

/// Contacts with solid walls of the bodies near one.
struct SolidNotes {
  /// Contacts of a body there is room for at first.
  static constexpr Index kSlots = 6;

  Span<const Index> body;        ///< [near bodies] ascending
  Span<const Offset> begin;      ///< [near bodies + 1] places of each, exactly; empty: kSlots each
  Span<SameList> same;           ///< [near bodies] envelopes for which they are found
  Span<Index> count;             ///< [near bodies] contacts of each
  Span<std::uint32_t> element;   ///< [places] of each body, ascending
  Span<HoldingPlane> way_plane;  ///< [places] of contacts met on the way; others have no normal

  SCREE_HD Offset first(Index k) const {
    return begin.empty() ? static_cast<Offset>(k) * kSlots : begin[k];
  }
  SCREE_HD Index room(Index k) const { return static_cast<Index>(first(k + 1) - first(k)); }

  /// Of contact `element` of body a; null: none.
  SCREE_HD const HoldingPlane* way(Index a, std::uint32_t wanted) const {
    const Index k = first_not_below(body, 0, static_cast<Index>(body.size), a);
    for (Offset place = first(k); place < first(k) + count[k]; ++place) {
      if (element[place] != wanted) continue;
      return norm2(way_plane[place].normal) > 0 ? &way_plane[place] : nullptr;
    }
    return nullptr;
  }
};

/// Marks free bodies that may touch a solid wall, whatever their margins.
/// Bytes per body, besides walls from the caches: 40 read, 4 written.
template <ShapeMix kMix, class Real>
struct FlagNearSolids {
  static constexpr const char* name = "flag_near_solids";
  ContactTest<kMix, Real> test;
  BodyParts<Real> parts;  ///< where `test` is of parts
  Span<Index> flag;       ///< [owned_count] out: 0 or 1

  SCREE_HD void operator()(Index a) const {
    const BodySample body = test.load(a);
    const ContactRange& range = test.range;
    // Margins are those of whole bodies, in float.
    const double radius =
        parts.is_used() ? static_cast<double>(parts.bodies.radius[parts.owner[a]]) : body.radius;
    const double margin = 2.000001 * range.margin_limit * radius;
    const bool is_there = inflated_radius(test.bodies, range, a) > 0;
    flag[a] = is_there && is_near_solids<kMix>(test.walls, range, body,
                                               wall_envelope(range, a, body) + margin)
                  ? 1
                  : 0;
  }
};

/// Finds the contacts of the bodies near solid walls, and returns whether there was no room for all of them: then they
/// are counted, and it has to be done again. Bodies keep what the listing before found where that holds.
template <ShapeMix kMix, class Real>
struct FindSolidContacts {
  static constexpr const char* name = "find_solid_contacts";
  static constexpr int kBlockThreads = 8;  // of a warp: they take different ways through meshes
  ContactTest<kMix, Real> test;
  SolidNotes notes;
  bool is_again;  ///< the notes are those of another listing of the step

  SCREE_HD Largest<Index> operator()(Index k) const {
    const Index a = notes.body[k];
    const BodySample body = test.load(a);
    const double envelope = wall_envelope(test.range, a, body);
    if (is_again && notes.same[k].holds(envelope)) return {};
    Note note{notes, notes.first(k), notes.room(k)};
    notes.same[k] = visit_solids<kMix>(test.walls, test.range, body, envelope, note);
    notes.count[k] = note.count;
    return {note.count > note.room ? 1 : 0};
  }

 private:
  struct Note {
    const SolidNotes& notes;
    Offset first;
    Index room;
    Index count = 0;
    SCREE_HD void operator()(std::uint32_t element) { way(element, {}); }
    SCREE_HD void way(std::uint32_t element, const HoldingPlane& plane) {
      if (count < room) {
        notes.element[first + count] = element;
        notes.way_plane[first + count] = plane;
      }
      ++count;
    }
  };
};

/// Adds them to the contacts of the last piece of each body.
struct AddSolidContacts {
  static constexpr const char* name = "add_solid_contacts";
  SolidNotes notes;
  CandidateView candidates;
  Span<Index> count;  ///< [piece count] in, out

  SCREE_HD void operator()(Index k) const {
    count[candidates.last_piece(notes.body[k])] += notes.count[k];
  }
};

/// Writes their keys, which come last among those of each body.
struct WriteSolidKeys {
  static constexpr const char* name = "write_solid_keys";
  SolidNotes notes;
  CandidateView candidates;
  Span<const Offset> begin;  ///< [piece count + 1] scan of the counts
  Span<std::uint64_t> key;   ///< [contact count] out

  SCREE_HD void operator()(Index k) const {
    const Index a = notes.body[k], count = notes.count[k];
    const Offset first = begin[candidates.last_piece(a) + 1] - count;
    const Offset noted = notes.first(k);
    for (Index j = 0; j < count; ++j) key[first + j] = make_key(a, notes.element[noted + j]);
  }
};

/// Turns their keys into contacts. Bytes per contact of any kind: 8 read.
template <ShapeMix kMix, class Real>
struct FillSolidContacts {
  static constexpr const char* name = "fill_solid_contacts";
  static constexpr int kLeastBlocks = kMix != ShapeMix::any ? 1 : 2;
  ContactTest<kMix, Real> test;
  SolidNotes notes;
  Span<const std::uint64_t> key;
  ContactArrays<Real> out;

  SCREE_HD void operator()(Index c) const {
    const std::uint32_t element = key_element(key[c]);
    if (element < test.keys.solid_begin) return;
    const Index a = contact_body(key[c]);
    const BodySample body = test.load(a);
    const WallSolid& solid = solid_of(test.walls, element);
    out.store(
        c, a, solid.body,
        solid_contact<kMix>(test.walls, test.range, solid, body, element, notes.way(a, element)));
  }
};

}  // namespace scree
