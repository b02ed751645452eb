#pragma once
// Parts of a state of rigid bodies: the bodies and contacts of one rank, and contacts on their way to another one. Contacts
// are known by the names of the parts that touch, see PartNames.

#include <functional>
#include <vector>

#include "dynamics/part_names.h"
#include "host/world_state.h"
#include "kernels/backend/ranks.h"
#include "kernels/types.h"

namespace scree {

/// The part of a state that a rank needs: the bodies whose places it owns, and their contacts.
WorldState shared_part(const WorldState& state, const std::function<bool(const Vec3d&)>& owns,
                       const PartNames& names);
/// Only the arrays of contacts.
WorldState contacts_of(const WorldState& state);
/// Arrays of contacts without rows.
WorldState no_contacts();

/// These rows of contacts, for another rank.
Bytes packed_contacts(const WorldState& contacts, const std::vector<std::size_t>& rows);
/// Appends them. @throws RunError when they are not those of packed_contacts()
void append_contacts(const Bytes& packed, WorldState& contacts);

/// Leaves out contacts that are not among these parts, and of those that are there twice the later ones. Part A is one of an
/// owned body then.
/// @param name  of all parts, in storage order; -1 where none is  @param owned_count  of them at the front
void keep_known_contacts(const std::vector<Index>& name, Index owned_count, WorldState& contacts);

/// Checks that the arrays of a state have a row for each body and for each contact. @param vectors  of an impulse
/// @throws InputError naming the array
void require_rows(const WorldState& state, std::size_t bodies, std::size_t vectors);

}  // namespace scree
