#pragma once
// Collision detection of one step, from bodies to sorted contacts, and the memory
// of their impulses.

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "collision/broad_phase.h"
#include "collision/impact_margins.h"
#include "collision/mixed_contacts.h"
#include "collision/numbering.h"
#include "collision/obstacle_buffers.h"
#include "collision/pair_candidates.h"
#include "collision/pair_filter.h"
#include "collision/persistent_contacts.h"
#include "collision/solid_contacts.h"
#include "kernels/contact/contact_elements.h"
#include "kernels/narrow_phase/contact_groups.h"
#include "kernels/narrow_phase/contact_list.h"
#include "kernels/narrow_phase/part_contacts.h"

namespace scree {

struct CollisionSettings {
  double envelope = 0;                            ///< contacts are listed up to this gap [m], >= 0
  ContactLayout layout = ContactLayout::general;  ///< radial: no lever arms are stored; mixed: of
                                                  ///< general contacts only, which come last
  Vec3<double> period;                            ///< period lengths [m]; zero: axis not periodic
  double margin_limit = 0;  ///< largest margin around impacts, as a fraction of the diameter [-]
  double lift = 0;          ///< largest separation speed that the contact law asks for, per sliding
                            ///< speed [-]: the friction of the convex law, 0 for the exact one
  double bounce_threshold = 0;  ///< approach speed up to which bodies do not bounce [m/s]
  double bounce = 0;  ///< largest restitution of bodies that may bounce repeatedly in a step [-]
  double skin = 0;    ///< how far two bodies together may come nearer, about, until pairs of near
                      ///< bodies are listed again [m]; 0: for every listing of contacts
  bool keep_candidates = true;  ///< false: detect() frees the list of pairs at its end
  std::vector<std::array<int, 2>> held_pairs = {};  ///< ids of bodies that never have contacts
};

template <class B, class Real>
class ContactDetector {
 public:
  /// @throws std::runtime_error when the setting or the obstacles cannot be handled:
  ///         a negative or infinite envelope or period, a wall of an unknown kind, or bodies that
  ///         have no pair function
  ContactDetector(B& b, const CollisionSettings& settings, const ObstacleData<Real>& obstacles);

  /// Lists the contacts of all bodies. A contact is listed when its gap is at most the envelope, or
  /// will be within the time step at the speed of the two surfaces after loads, so that fast bodies
  /// do not tunnel, nor those that fall far in a step. Where gravity moves bodies by more than half
  /// the envelope in a step, pairs are listed by as much farther, to a quarter of a diameter each:
  /// one may be held up and the other fall. Contacts through a periodic side are those
  /// with the nearest image.
  ///
  /// A body that is hit within the step moves where it was not expected. So when a contact may push
  /// its bodies farther than half the envelope, bodies get margins, see ImpactMargins, by which all
  /// that they may then meet is listed too; bodies that move side by side get none. The detection
  /// is done again with the margins, and once more when contacts found by that make margins grow,
  /// for the bodies behind.
  ///
  /// Contacts are picked from a list of pairs of near bodies, which reaches farther by a skin. When
  /// a few bodies have moved too far since it was made, it is extended, and rebuilt when many
  /// have, see PairCandidates. The contacts do not depend on it.
  ///
  /// Three host reads: whether the list still serves, the number of contacts, and the largest push;
  /// one more to extend the list and three more for a new one; up to five more for each
  /// detection with margins. Where there are solid walls, one more, and one for each detection;
  /// where bodies are not all spheres, two more for each detection, see MixedContacts.
  ///
  /// Bytes moved a body by a listing, spheres in float with m candidates and k contacts each,
  /// every array counted once: check 60, candidates 56 + 12 m, scan 12, keys 24 + 12 k,
  /// geometry (8 + 24 + 36) k; about 150 + 12 m + 80 k = 450 for m = 5 and k = 3. A new list
  /// takes about 230 for the bins (extent and levels 52, cells 60, records 84, and 16 a cell), and
  /// 152 + 40 m = 350 for itself. Its search also reads about 4 ranges of records and 14 records
  /// of 16 bytes in a bed of equal spheres, 7 and 17 in one of diameters 1 : 10, from the caches,
  /// because rows of cells follow the Morton order.
  ///
  /// Memory, radial layout in float, for good: 25 + 4 m bytes a body for the list (nothing when it
  /// is not kept) and 24 a contact, and 20 more for what is remembered of it. While detect() works:
  /// up to 138 + 12 m a body for a new list, and 69 a slice (see PairSearch: about one a body for
  /// diameters 1 : 10, none for equal spheres), or 9 + 8 m to extend one; 28 + 4 m a body and 8 a
  /// contact to pick contacts.
  ///
  /// @param h             time step [s]
  /// @param gravity_step  what gravity adds to the velocity of free bodies in the step, h g [m/s]
  /// @param load_speed    most that other loads add to it, which `bodies` has already [m/s]
  /// @param parts         where `bodies` are parts: contacts are those of the bodies that have them, and parts
  ///                      of one body have none
  /// @throws std::runtime_error when there are more contacts, or pairs of near bodies, than
  ///         an Index can number, or more bodies and wall features than fit a contact key
  void detect(B& b, const BodyView<Real>& bodies, double h, const Vec3<double>& gravity_step,
              double load_speed = 0, const BodyParts<Real>& parts = {});

  /// The contacts found by the last detect(); valid until the next one.
  ContactView<Real> contacts() const;
  /// The walls as the last detect() found them.
  WallView<Real> walls() const { return obstacles_.walls(); }
  /// Bodies that never have contacts with each other.
  IgnoredPairs held_pairs() const { return held_pairs_.pairs(); }

  /// Warm start of the present contacts. @param impulse [vectors * contacts().count] out [N s]
  void match(B& b, int vectors, Span<Vec3<Real>> impulse) const {
    memory_.match(b, contacts().key, vectors, impulse);
  }
  /// Gives back the memory of the last step, once everything is matched.
  void forget() { memory_.forget(); }
  /// Remembers impulses of the present contacts for the next step to start from, and takes their memory over.
  void keep(int vectors, Buffer<B, Vec3<Real>>&& impulse) {
    memory_.keep(std::move(found_.key), contact_count_, vectors, std::move(impulse));
  }
  /// What keep() was given.
  Span<const Vec3<Real>> impulses() const { return memory_.impulses(); }
  /// The same for what the solver leaves at the contacts, -1 at new ones; keep() comes first.
  /// @param mark  [contacts().count]
  void match_marks(B& b, Span<Index> mark) const { memory_.match_marks(b, contacts().key, mark); }
  void keep_marks(Buffer<B, Index>&& mark) { memory_.keep_marks(std::move(mark)); }

  /// Follows a reordering of the owned bodies. The contacts of the last detect() are void after it.
  /// @param bodies      needed for the names of their contacts, which a restored detector lacks
  /// @param new_of_old  [owned_count] new storage index of each owned body
  void remap(B& b, const BodyView<Real>& bodies, Span<const Index> new_of_old) {
    name_elements(bodies);
    candidates_.release();  // void, and its memory is about what the sort needs for the moment
    memory_.remap(b, keys_, new_of_old);
    contact_count_ = radial_count_ = 0;
  }

  /// How far detect() looks for contacts, before margins.
  ContactRange range_of(const BodyView<Real>& bodies, double h, const Vec3<double>& gravity_step,
                        double load_speed) const;

  /// With several ranks: detect() is then a call that all make together. Contacts with ghosts are listed by both owners,
  /// by the same numbers.
  void set_ghosts(const Ghosts<B>* ghosts) { ghosts_ = ghosts; }
  /// Follows ghosts that came, went or changed places. @param new_of_old  new place of each old ghost, -1: gone
  void rename_ghosts(B& b, Index owned_count, const std::vector<Index>& new_of_old) {
    candidates_.forget();
    memory_.rename_ghosts(b, keys_, owned_count, new_of_old);
    contact_count_ = radial_count_ = 0;
  }

  /// Fixed bodies move back in storage by so many places: what is remembered of the last step is void, and so are its contacts.
  void follow_fixed_bodies(B& b, Index shift) {
    forget_places();
    contact_count_ = radial_count_ = 0;
    obstacles_.follow_fixed_bodies(b, shift);
  }

  /// Bodies were put elsewhere: what is remembered of the last step and of near pairs is void.
  void forget_places() {
    memory_.forget();
    candidates_.forget();
  }

  /// Whether the list of near pairs is about to be made anew. Ranks make theirs in the same step: one that does alone has the
  /// others wait for it.
  bool has_spent_list() const { return candidates_.is_spent(); }
  /// A list is made in the next detection.
  void renew_list() { candidates_.retire(); }

  /// The remembered keys and impulses, for checkpoints.
  void save(B& b, std::vector<std::uint64_t>& key, std::vector<Vec3<double>>& impulse) const {
    memory_.save(b, key, impulse);
  }
  void restore(B& b, const std::vector<std::uint64_t>& key,
               const std::vector<Vec3<double>>& impulse) {
    memory_.restore(b, key, impulse, vectors_per_contact(settings_.layout));
    candidates_.forget();
  }

  /// The remembered marks, empty when none were kept; restore() comes first.
  std::vector<Index> save_marks(B& b) const { return download(b, memory_.marks()); }
  void restore_marks(B& b, const std::vector<Index>& mark) {
    Buffer<B, Index> marks(b);
    upload(b, mark, marks);
    memory_.keep_marks(std::move(marks));
  }

  /// How contact keys are built; set by detect() and name_elements().
  const ContactKeys& keys() const { return keys_; }
  const ContactKeys& name_elements(const BodyView<Real>& bodies);

  /// Lists of pairs of near bodies made so far.
  std::int64_t list_builds() const { return candidates_.build_count(); }
  /// How often one was extended because a few bodies had moved too far.
  std::int64_t list_extensions() const { return candidates_.extension_count(); }

 private:
  /// Most detections with margins in a step. One leaves overlaps of several percent of a diameter
  /// in a loose bed, more than two change little.
  static constexpr int kMaxWidenings = kMostSearches - 1;

  void list_with_margins(B& b, const BodyView<Real>& bodies, ContactRange range);
  template <ShapeMix kMix>
  void list_contacts(B& b, const ContactTest<kMix, Real>& test);
  template <ShapeMix kMix>
  ContactTest<kMix, Real> test_of(const BodyView<Real>& bodies, const ContactRange& range) const {
    return {bodies, obstacles_.shapes(), candidates_.view(), obstacles_.walls(), range,
            keys_,  parts_.is_used()};
  }
  /// Calls f with what the run holds.
  template <class F>
  void with_mix(F&& f) const {
    switch (obstacles_.mix()) {
      case ShapeMix::spheres_and_planes:
        return f(std::integral_constant<ShapeMix, ShapeMix::spheres_and_planes>{});
      case ShapeMix::spheres:
        return f(std::integral_constant<ShapeMix, ShapeMix::spheres>{});
      case ShapeMix::any:
        return f(std::integral_constant<ShapeMix, ShapeMix::any>{});
    }
  }
  template <ShapeMix kMix>
  void count_contacts(B& b, const ContactTest<kMix, Real>& test, Span<Index> count,
                      Span<std::uint32_t> touching);
  void group_keys(B& b, const BodyView<Real>& bodies, Span<std::uint64_t> key);
  void list_within(B& b, const BodyView<Real>& bodies, const ContactRange& range);
  void release_contacts();

  CollisionSettings settings_;
  BodyParts<Real> parts_;  ///< while detect() works
  const Ghosts<B>* ghosts_ = nullptr;
  ObstacleBuffers<B, Real> obstacles_;
  PairFilter<B> held_pairs_;
  PairCandidates<B, Real> candidates_;
  SolidContacts<B, Real> solids_;
  MixedContacts<B, Real> mixed_;
  PersistentContacts<B, Real> memory_;
  ContactKeys keys_;
  Index contact_count_ = 0;
  Index radial_count_ = 0;   ///< of those, without stored arms
  Buffer<B, float> needed_;  ///< envelopes that contacts of the candidates take; empty: not known
  FoundContacts<B, Real> found_;
};

template <class B, class Real>
ContactDetector<B, Real>::ContactDetector(B& b, const CollisionSettings& settings,
                                          const ObstacleData<Real>& obstacles)
    : settings_(settings),
      obstacles_(b, obstacles, settings.period),
      held_pairs_(b, settings.held_pairs),
      candidates_(b),
      solids_(b),
      mixed_(b),
      memory_(b),
      needed_(b),
      found_(b) {
  const auto check = [](double value, const char* what, const char* unit = " m") {
    if (!(value >= 0 && value < 1e30)) {
      throw std::runtime_error(std::string(what) + " must be finite and not negative, got " +
                               std::to_string(value) + unit);
    }
  };
  check(settings.envelope, "contact envelope");
  check(settings.margin_limit, "margin limit", "");
  check(settings.lift, "lift", "");
  check(settings.bounce, "bounce", "");
  check(settings.skin, "skin");
  for (int k = 0; k < 3; ++k) check(settings.period[k], "period");
}

template <class B, class Real>
void ContactDetector<B, Real>::detect(B& b, const BodyView<Real>& bodies, double h,
                                      const Vec3<double>& gravity_step, double load_speed,
                                      const BodyParts<Real>& parts) {
  release_contacts();
  parts_ = parts;
  needed_.release();
  name_elements(bodies);
  mixed_.release();
  if (bodies.owned_count == 0 && ghosts_ == nullptr) return;
  const ContactRange range = range_of(bodies, h, gravity_step, load_speed);
  obstacles_.refresh(b, bodies, range, keys_);
  with_mix([&]<ShapeMix kMix>(std::integral_constant<ShapeMix, kMix>) {
    if constexpr (kMix != ShapeMix::spheres_and_planes) {
      if (obstacles_.walls().solids.size > 0 && bodies.owned_count > 0)
        solids_.start(b, test_of<kMix>(bodies, range), parts_);
    }
  });
  list_with_margins(b, bodies, range);
  solids_.release();
  mixed_.release();
  needed_.release();
  if (!settings_.keep_candidates) candidates_.release();
  parts_ = {};
}

template <class B, class Real>
ContactRange ContactDetector<B, Real>::range_of(const BodyView<Real>& bodies, double h,
                                                const Vec3<double>& gravity_step,
                                                double load_speed) const {
  const double fall = h * (norm(gravity_step) + load_speed);
  ContactRange range{settings_.envelope, h, settings_.period, {}, gravity_step};
  range.fall = fall > 0.5 * settings_.envelope ? 0.5 * fall : 0;
  range.margin_limit = settings_.margin_limit;
  if (free_linear_axes(bodies.locks.shared) == 7u) {
    range.first_held = std::min(bodies.locks.first, bodies.fixed_begin);
  }
  return range;
}

template <class B, class Real>
void ContactDetector<B, Real>::list_with_margins(B& b, const BodyView<Real>& bodies,
                                                 ContactRange range) {
  list_within(b, bodies, range);
  if (!(settings_.margin_limit > 0)) return;
  if (ghosts_ == nullptr && contact_count_ == 0) return;  // other ranks may have some
  ImpactMargins<B, Real> margins(b);
  Buffer<B, float> of_parts(b);
  const BodyView<Real>& owners = parts_.is_used() ? parts_.bodies : bodies;
  const double least = 0.5 * settings_.envelope;
  for (int k = 0; k < kMaxWidenings; ++k) {
    const Index before = contact_count_;
    const ImpactGraph<Real> graph{owners,         contacts(),       range,
                                  settings_.lift, settings_.bounce, settings_.bounce_threshold};
    const double largest_push = margins.start(b, graph, ghosts_);
    if (k == 0 && !(largest_push > least)) return;
    range.margin = margins.spread(b, graph, ghosts_);
    if (parts_.is_used()) {
      const Span<float> spread = of_parts.resize_discard(bodies.moving_count);
      for_each(b, bodies.moving_count, SpreadToParts{parts_.owner, range.margin, spread});
      range.margin = std::as_const(of_parts).view(bodies.moving_count);
    }
    // Margins that grew by less than calls for margins at all are not worth another detection.
    if (k > 0 && !(margins.growth(b, owners.moving_count) > least)) return;
    list_within(b, bodies, range);
    if (!on_any_rank(b, contact_count_ != before)) return;
  }
}

template <class B, class Real>
void ContactDetector<B, Real>::list_within(B& b, const BodyView<Real>& bodies,
                                           const ContactRange& range) {
  if (bodies.owned_count == 0) return;
  if (!candidates_.covers(b, bodies, range)) {
    release_contacts();
    candidates_.renew(b, bodies, range, {settings_.skin}, needed_);
  }
  with_mix([&]<ShapeMix kMix>(std::integral_constant<ShapeMix, kMix>) {
    list_contacts(b, test_of<kMix>(bodies, range));
  });
}

template <class B, class Real>
const ContactKeys& ContactDetector<B, Real>::name_elements(const BodyView<Real>& bodies) {
  const ContactElements elements{
      static_cast<std::uint64_t>(bodies.count), obstacles_.feature_bits(),
      static_cast<std::uint64_t>(obstacles_.plane_count()), obstacles_.solid_elements()};
  if (!elements.fit()) {
    throw std::runtime_error(std::to_string(elements.end()) + " names of contacts, of " +
                             std::to_string(bodies.count) + " bodies with " +
                             std::to_string(elements.feature_bits) +
                             " bits for features and of walls, do not fit 32 bits");
  }
  keys_.feature_bits = elements.feature_bits;
  keys_.has_groups = settings_.layout == ContactLayout::mixed;
  keys_.wall_begin = static_cast<std::uint32_t>(elements.wall_begin());
  keys_.solid_begin = static_cast<std::uint32_t>(elements.solid_begin());
  return keys_;
}

/// The contacts of before are void; their memory serves the search for new ones.
template <class B, class Real>
void ContactDetector<B, Real>::release_contacts() {
  contact_count_ = radial_count_ = 0;
  found_.release();
}

/// Reads bodies once for each list: margins change which candidates are contacts,
/// but not what it takes.
template <class B, class Real>
template <ShapeMix kMix>
void ContactDetector<B, Real>::count_contacts(B& b, const ContactTest<kMix, Real>& test,
                                              Span<Index> count, Span<std::uint32_t> touching) {
  const Index pieces = test.candidates.piece_count();
  if (needed_.capacity() > 0) {
    for_each(b, pieces,
             RecountContacts<kMix, Real>{test, needed_.view(needed_.capacity()), count, touching});
  } else {
    const bool is_asked = settings_.margin_limit > 0;
    const Span<float> needed = needed_.resize_discard(is_asked ? test.candidates.other.size : 0);
    for_each(b, pieces, CountContacts<kMix, Real>{test, count, touching, needed});
  }
}

template <class B, class Real>
template <ShapeMix kMix>
void ContactDetector<B, Real>::list_contacts(B& b, const ContactTest<kMix, Real>& test) {
  const Index pieces = test.candidates.piece_count();
  Buffer<B, Index> count(b, pieces);
  Buffer<B, std::uint32_t> touching(b);
  Buffer<B, Offset> begin(b, static_cast<Offset>(pieces) + 1);
  if constexpr (kMix == ShapeMix::any) {  // no notes: bodies are read again
    mixed_.find(b, test, count.view());
  } else {
    count_contacts(b, test, count.view(), touching.resize_discard(pieces));
  }
  if constexpr (kMix != ShapeMix::spheres_and_planes) {
    if (solids_.is_used()) solids_.count(b, test, count.view());
  }
  exclusive_scan(b, Span<const Index>(count.view()), begin.view());
  const Offset total = fetch(b, begin.data() + pieces);
  contact_count_ = checked_index(total, can_number(total), "contacts");
  if constexpr (kMix != ShapeMix::spheres_and_planes) {
    if (solids_.is_used()) solids_.complete(b, test);
  }
  Span<std::uint64_t> key = found_.key.resize_discard(total);
  if constexpr (kMix == ShapeMix::any) {
    mixed_.write_keys(b, test, begin.view(), key);
  } else {
    for_each(b, pieces, WriteContactKeys<kMix, Real>{test, begin.view(), touching.view(), key});
  }
  if (solids_.is_used()) solids_.write_keys(b, test.candidates, begin.view(), key);

  radial_count_ = settings_.layout == ContactLayout::radial ? contact_count_ : 0;
  if (settings_.layout == ContactLayout::mixed) {
    group_keys(b, test.bodies, key);
    key = found_.key.view(total);
  }
  found_.resize_discard(ContactParts(settings_.layout), total, radial_count_);  // keeps the keys
  const ContactArrays<Real> out{found_.spans(), radial_count_};
  if constexpr (kMix == ShapeMix::any) {
    mixed_.fill(b, test, candidates_.has_passes(), key, out);
  } else {
    const auto fill_contacts = [&]<bool kPasses>(std::bool_constant<kPasses>) {
      for_each(b, contact_count_,
               FillContacts<kMix, kPasses, Real>{test.bodies, test.shapes, test.walls.planes,
                                                 test.range, keys_, key, out});
    };
    if (candidates_.has_passes()) {
      fill_contacts(std::true_type{});
    } else {
      fill_contacts(std::false_type{});
    }
  }
  if constexpr (kMix != ShapeMix::spheres_and_planes) {
    if (solids_.is_used()) solids_.fill(b, test, key, out);
  }
  if (parts_.is_used()) {
    if (radial_count_ > 0) throw std::logic_error("parts of bodies have contacts with arms");
    for_each(b, contact_count_,
             MoveContactsToBodies<Real>{parts_, out.body_a, out.body_b, out.arm_a, out.arm_b});
  }
  if (!held_pairs_.is_used()) return;
  if (radial_count_ > 0) throw std::logic_error("bodies that joints hold have contacts with arms");
  const Span<const Index> id = parts_.is_used() ? parts_.bodies.id : test.bodies.id;
  contact_count_ = held_pairs_.apply(b, id, contact_count_, found_);
}

/// Brings the keys into groups; one host read.
template <class B, class Real>
void ContactDetector<B, Real>::group_keys(B& b, const BodyView<Real>& bodies,
                                          Span<std::uint64_t> key) {
  const Index n = contact_count_;
  Buffer<B, Index> flag(b, n);
  Buffer<B, Offset> before(b, static_cast<Offset>(n) + 1);
  Buffer<B, std::uint64_t> grouped(b, n);
  for_each(b, n, FlagGeneral<Real>{bodies, obstacles_.walls(), keys_, key, flag.view()});
  exclusive_scan(b, Span<const Index>(flag.view()), before.view());
  radial_count_ = n - static_cast<Index>(fetch(b, before.data() + n));
  for_each(b, n, GroupKeys{key, flag.view(), before.view(), radial_count_, grouped.view(n)});
  if (obstacles_.mix() == ShapeMix::any) mixed_.group(b, flag.view(), before.view(), radial_count_);
  swap(found_.key, grouped);
}

template <class B, class Real>
ContactView<Real> ContactDetector<B, Real>::contacts() const {
  ContactView<Real> view;
  view.count = contact_count_;
  view.radial_count = radial_count_;
  const ContactParts parts(settings_.layout);
  view.visit(
      [&](const ContactField& field, auto& values, const auto& array) {
        const Offset size = field.size(parts, contact_count_, radial_count_);
        if (size <= array.capacity()) values = array.view(size);
      },
      view, found_);
  if (view.key.size < contact_count_) view.key = memory_.keys();  // it has them after keep()
  return view;
}

}  // namespace scree
