#pragma once
// Contacts by the ids of their bodies, which is how they leave a simulation: keys name places of
// storage, which another run, or another rank, may give to other bodies.

#include <cstdint>
#include <vector>

#include "kernels/contact/contact_key.h"

namespace scree {

struct NamedContacts {
  std::vector<std::int32_t> body_a;    ///< id of an owned body
  std::vector<std::int32_t> body_b;    ///< id of the other body; -1: a wall
  std::vector<std::uint64_t> feature;  ///< which contact of the two; at a wall: which part of the
      ///< walls, in the order of the scene. Highest bit: as in keys
};

/// @param id  [count] of all bodies, in storage order
inline NamedContacts names_of(const std::vector<std::uint64_t>& keys, const ContactKeys& rule,
                              const std::vector<Index>& id) {
  NamedContacts names;
  names.body_a.reserve(keys.size());
  names.body_b.reserve(keys.size());
  names.feature.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    const std::uint32_t element = key_element(key);
    const bool is_body = rule.is_body(element);
    names.body_a.push_back(id[static_cast<std::size_t>(contact_body(key))]);
    names.body_b.push_back(is_body ? id[static_cast<std::size_t>(rule.body(element))] : -1);
    names.feature.push_back((key & kGeneralGroup) |
                            (is_body ? rule.feature(element) : element - rule.wall_begin));
  }
  return names;
}

/// Keys of contacts, and which of them have their bodies the other way round: key() names the owned
/// body with the lower place first.
struct PlacedContacts {
  std::vector<std::uint64_t> key;
  std::vector<std::uint8_t> is_flipped;
};

/// @param id          [count] of all bodies, in storage order; -1 where none is
/// @param owned_count  of them at the front
/// @throws InputError when a name is not one of a contact of these bodies
PlacedContacts keys_of(const NamedContacts& names, const ContactKeys& rule,
                       const std::vector<Index>& id, Index owned_count);

/// The order in which keys ascend; empty when they do.
std::vector<std::size_t> ascending_order(const std::vector<std::uint64_t>& key);

}  // namespace scree
