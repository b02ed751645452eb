#pragma once
// The state of a run as one of other bodies takes it over: World::add() and remove().

#include <vector>

#include "host/world_state.h"
#include "kernels/contact/contact_view.h"

namespace scree {

/// What names of contacts stand for in a run.
struct ContactNaming {
  Index id_count = 0;  ///< see PartNames
  ContactLayout layout = ContactLayout::radial;
};

/// Adds to a state what change_state() has to know of its run.
/// @param part_owner  ids of bodies, by part
void leave_naming(const ContactNaming& naming, const std::vector<Index>& part_owner, WorldState& s);

/// Turns a state into one of a run of other bodies: rows and contacts of those that are no more are left out, contacts get
/// the names that they have there.
/// @param naming   of the run to come
/// @param removed  ids of bodies that are no more, rising
/// @param own      bodies of that run as they are described: new ones come behind the others
void change_state(const ContactNaming& naming, const std::vector<int>& removed,
                  const WorldState& own, WorldState& s);

}  // namespace scree
