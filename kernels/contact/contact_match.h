#pragma once
// Element programs that carry impulses from the contacts of one step to those of the next.

#include "kernels/backend/backend.h"
#include "kernels/contact/contact_key.h"
#include "kernels/math/vec3.h"

namespace scree {

/// First position whose key is not below `key`. The search widens from `hint` outward, so a close
/// guess costs a few reads however long the list is.
SCREE_HD inline Offset lower_bound_near(Span<const std::uint64_t> sorted, std::uint64_t key,
                                        Offset hint) {
  Offset low = 0, high = sorted.size;  // sorted[low - 1] < key <= sorted[high]
  if (hint > high) hint = high;
  Offset width = 1;
  if (hint < high && sorted[hint] < key) {
    low = hint + 1;
    while (low + width < high && sorted[low + width] < key) {
      low += width + 1;
      width *= 2;
    }
    if (low + width < high) high = low + width;
  } else {
    high = hint;
    while (high - width >= low && !(sorted[high - width] < key)) {
      high -= width;
      width *= 2;
    }
    if (high - width >= low) low = high - width + 1;
  }
  while (low < high) {
    const Offset middle = low + (high - low) / 2;
    if (sorted[middle] < key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/// Position of contact c's key in the sorted keys of the step before, -1 for a new contact. Both
/// lists are ascending, so it lies near the same fraction of the list.
SCREE_HD inline Offset find_contact(Span<const std::uint64_t> previous_key,
                                    Span<const std::uint64_t> key, Index c) {
  const Offset hint = key.size > 0 ? c * previous_key.size / key.size : 0;
  const Offset k = lower_bound_near(previous_key, key[c], hint);
  return k < previous_key.size && previous_key[k] == key[c] ? k : -1;
}

/// Impulse of the same contact in the step before, zero for a new contact.
/// Bytes per contact (float, one vector): 16 + 12 read, 12 written.
template <class Real>
struct MatchImpulses {
  static constexpr const char* name = "match_impulses";
  Span<const std::uint64_t> previous_key;   ///< [m] ascending
  Span<const Vec3<Real>> previous_impulse;  ///< [m * vectors]
  Span<const std::uint64_t> key;            ///< [n] ascending
  int vectors = 1;                          ///< impulse vectors per contact, next to each other
  Span<Vec3<Real>> impulse;                 ///< [n * vectors] out

  SCREE_HD void operator()(Index c) const {
    const Offset k = find_contact(previous_key, key, c);
    for (int v = 0; v < vectors; ++v) {
      impulse[static_cast<Offset>(c) * vectors + v] =
          k >= 0 ? previous_impulse[k * vectors + v] : Vec3<Real>{};
    }
  }
};

/// What impulses of the next step start from: the mean of the steps so far, in which old ones fade.
///
/// A solve leaves errors e in the velocities at contacts, and they are gaps in the step after. Bodies at rest have impulses
/// s + e_k - 2 e_(k-1) + e_(k-2) in step k, where s carries their weight and each e is an impulse that would make that error: the step takes its
/// own error in, and errors of the two steps before out again. The next step wants s - 2 e_k + e_(k-1), so that it starts
/// 3 e_k - 3 e_(k-1) + e_(k-2) away with the impulses of this step, and 2 e_k - e_(k-1) with s: half as far. In the mean errors cancel.
template <class Real>
struct AverageImpulses {
  static constexpr const char* name = "average_impulses";
  /// Weight of this step. With less, beds at rest take fewer iterations still, but sink faster in float: errors
  /// within the tolerance are made up for later.
  static constexpr Real kNewest = static_cast<Real>(0.5);
  Span<const Vec3<Real>> impulse;  ///< found in this step
  Span<Vec3<Real>> guess;          ///< in: this step started from it; out: the next one does

  SCREE_HD void operator()(Index k) const {
    const Vec3<Real> was = guess[k], is = impulse[k];
    const bool goes_on = norm2(was) > 0 && norm2(is) > 0;
    guess[k] = goes_on ? was + kNewest * (is - was) : is;
  }
};

/// What the solver left at the same contact in the step before, -1 at a new contact.
struct MatchMarks {
  static constexpr const char* name = "match_marks";
  Span<const std::uint64_t> previous_key;  ///< [m] ascending
  Span<const Index> previous_mark;         ///< [m]
  Span<const std::uint64_t> key;           ///< [n] ascending
  Span<Index> mark;                        ///< [n] out

  SCREE_HD void operator()(Index c) const {
    const Offset k = find_contact(previous_key, key, c);
    mark[c] = k >= 0 ? previous_mark[k] : -1;
  }
};

/// The key of a contact that is to be forgotten: behind all others.
inline constexpr std::uint64_t kForgottenKey = ~std::uint64_t{0};

/// Keys after ghosts have changed places; they are body B of their contacts, and stay so.
struct RenameGhosts {
  static constexpr const char* name = "rename_ghosts";
  ContactKeys keys;
  Index owned_count;
  Span<const Index> new_of_old;  ///< of the ghosts before; -1: gone
  Span<std::uint64_t> key;       ///< in and out
  Span<Index> order;             ///< out: c

  SCREE_HD void operator()(Index c) const {
    order[c] = c;
    const std::uint32_t element = key_element(key[c]);
    if (!keys.is_body(element)) return;
    const Index ghost = keys.body(element) - owned_count;
    if (ghost < 0 || ghost >= new_of_old.size) return;
    const Index place = new_of_old[ghost];
    key[c] = place < 0 ? kForgottenKey
                       : (key[c] & kGeneralGroup) |
                             make_key(contact_body(key[c]),
                                      keys.body_element(place, keys.feature(element)));
  }
};

/// Contacts that are not forgotten.
struct CountKeys {
  static constexpr const char* name = "count_keys";
  Span<const std::uint64_t> key;
  SCREE_HD Sums<1> operator()(Index c) const { return {{key[c] == kForgottenKey ? 0.0 : 1.0}}; }
};

/// Keys after owned bodies have moved in storage. When the order of the two bodies flips, they
/// exchange their roles and the impulse, which acts on B, changes sign.
template <class Real>
struct RenameContacts {
  static constexpr const char* name = "rename_contacts";
  ContactKeys keys;
  Span<const Index> new_of_old;  ///< [owned_count] new storage index of an owned body
  int vectors = 1;
  Span<std::uint64_t> key;   ///< in and out
  Span<Vec3<Real>> impulse;  ///< in and out
  Span<Index> order;         ///< out: c

  SCREE_HD Index renamed(Index i) const { return i < new_of_old.size ? new_of_old[i] : i; }

  SCREE_HD void operator()(Index c) const {
    order[c] = c;
    const std::uint64_t group = key[c] & kGeneralGroup;
    const Index a = renamed(contact_body(key[c]));
    const std::uint32_t element = key_element(key[c]);
    if (!keys.is_body(element)) {
      key[c] = group | make_key(a, element);
      return;
    }
    const Index b = renamed(keys.body(element));
    const std::uint32_t feature = keys.feature(element);
    if (a < b) {
      key[c] = group | make_key(a, keys.body_element(b, feature));
      return;
    }
    key[c] = group | make_key(b, keys.body_element(a, feature));
    for (int v = 0; v < vectors; ++v) {
      Vec3<Real>& g = impulse[static_cast<Offset>(c) * vectors + v];
      g = -g;
    }
  }
};

}  // namespace scree
