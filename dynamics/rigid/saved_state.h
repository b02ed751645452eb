#pragma once
// What a run of rigid bodies needs to go on bit for bit: bodies, contacts, memory of the solver.

#include <optional>

#include "collision/contact_detector.h"
#include "dynamics/rigid/body_store.h"
#include "dynamics/rigid/contact_names.h"
#include "dynamics/rigid/part_store.h"
#include "host/world_state.h"
#include "solvers/solver.h"

namespace scree {

/// @param id_count  of all bodies that there can ever be
template <class B, class Real>
void save_state(B& b, BodyStore<B, Real>& store, PartStore<B, Real>& parts, Index id_count,
                const ContactDetector<B, Real>& detector, const Solver<B, Real>& solver,
                WorldState& s) {
  std::vector<std::uint64_t> key;
  std::vector<Vec3d> impulse;
  detector.save(b, key, impulse);  // first: needs room to convert
  store.save_owned(s);
  NamedContacts names = names_of(key, detector.keys(), parts.names(store.ids(), id_count));
  s.add("contact/body_a", std::move(names.body_a));
  s.add("contact/body_b", std::move(names.body_b));
  s.add("contact/feature", std::move(names.feature));
  s.add("contact/impulse", std::move(impulse));
  s.add("contact/mark", detector.save_marks(b));
  s.add("solver/memory", solver.memory());
}

/// Contacts of a state as a detector remembers them.
struct RememberedContacts {
  std::vector<std::uint64_t> key;
  std::vector<Vec3d> impulse;
  std::vector<Index> mark;  ///< empty: none

  /// Rows in another order. @param vectors  of an impulse
  void sort(const std::vector<std::size_t>& order, std::size_t vectors) {
    RememberedContacts sorted;
    for (const std::size_t c : order) {
      sorted.key.push_back(key[c]);
      for (std::size_t v = 0; v < vectors; ++v) sorted.impulse.push_back(impulse[c * vectors + v]);
      if (!mark.empty()) sorted.mark.push_back(mark[c]);
    }
    *this = std::move(sorted);
  }
};

/// @param name  [count] of all parts, in storage order, see PartNames  @param vectors  of an impulse
/// @throws InputError when they are not contacts of these bodies
inline RememberedContacts remembered_contacts(const WorldState& s, const ContactKeys& rule,
                                              const std::vector<Index>& name, Index owned_count,
                                              std::size_t vectors) {
  RememberedContacts contacts;
  contacts.impulse = s.at<Vec3d>("contact/impulse");
  if (s.has("contact/key")) {  // a checkpoint of version 1: places of storage, which are the same
    contacts.key = s.at<std::uint64_t>("contact/key");
    require_impulses(contacts.impulse.size(), contacts.key.size() * vectors);
    require_places(contacts.key, owned_count);
    return contacts;
  }
  contacts.mark = s.at<std::int32_t>("contact/mark");
  for (Index& mark : contacts.mark)
    if (mark < 0 || mark >= 1 << 30) mark = -1;  // of no solver
  const NamedContacts names{s.at<std::int32_t>("contact/body_a"),
                            s.at<std::int32_t>("contact/body_b"),
                            s.at<std::uint64_t>("contact/feature")};
  require_impulses(contacts.impulse.size(), names.body_a.size() * vectors);
  require_contact_rows({names.body_b.size(), names.feature.size(),
                        contacts.mark.empty() ? names.body_a.size() : contacts.mark.size()},
                       names.body_a.size());
  PlacedContacts placed = keys_of(names, rule, name, owned_count);
  contacts.key = std::move(placed.key);
  for (std::size_t c = 0; c < contacts.key.size(); ++c) {
    if (placed.is_flipped[c] == 0) continue;
    for (std::size_t v = 0; v < vectors; ++v)
      contacts.impulse[c * vectors + v] = -contacts.impulse[c * vectors + v];
  }
  const std::vector<std::size_t> order = ascending_order(contacts.key);
  if (!order.empty()) contacts.sort(order, vectors);
  return contacts;
}

/// @param vectors   of an impulse
/// @param id_count  of all bodies that there can ever be
/// @throws InputError when the state is not one of these bodies
template <class B, class Real>
void restore_state(B& b, const WorldState& s, int vectors, BodyStore<B, Real>& store,
                   PartStore<B, Real>& parts, Index id_count, ContactDetector<B, Real>& detector,
                   Solver<B, Real>& solver) {
  const auto n = static_cast<std::size_t>(store.owned_count());
  const std::vector<std::int32_t>& id = s.at<std::int32_t>("body/id");
  if (id.size() != n) throw_wrong_body_count(id.size(), n);
  store.arrange(id);
  store.restore_owned(s);
  parts.forget();
  const BodyView<Real> seen = parts.place(store.view());
  const RememberedContacts contacts =
      remembered_contacts(s, detector.name_elements(seen), parts.names(store.ids(), id_count),
                          seen.owned_count, static_cast<std::size_t>(vectors));
  detector.restore(b, contacts.key, contacts.impulse);
  // Marks of a checkpoint of version 1 are in the memory of the solver, and are lost.
  const bool has_own = !(s.has("contact/key") && solver.keeps_marks());
  if (solver.keeps_marks() && !contacts.mark.empty()) detector.restore_marks(b, contacts.mark);
  solver.restore_memory(has_own ? s.at<double>("solver/memory") : std::vector<double>{});
}

}  // namespace scree
