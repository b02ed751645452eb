#pragma once
// Bodies that overlap before the first step. A run pushes them apart, so it starts where nobody put
// them: worth a warning.

#include <cstdint>
#include <string>
#include <vector>

#include "host/body_constants.h"
#include "host/world.h"

namespace scree {

/// Overlaps deeper than what settled beds have: a thousandth of the thinner body's least extent.
struct Overlaps {
  std::int64_t pairs = 0;  ///< of bodies
  bool has_more = false;   ///< not all were counted
  int body_a = -1;         ///< ids of the pair that overlaps deepest
  int body_b = -1;
  double depth = 0;                   ///< of that pair [m]
  double fraction = 0;                ///< its depth over the least extent of the thinner body [-]
  std::string not_looked_for;         ///< why, when they could not be
  std::vector<std::string> warnings;  ///< of the World, where its dynamics list no contacts
};

/// Those among contacts, which are sorted by body. @param body  constants of all bodies, by id
Overlaps overlaps_among(const std::vector<ContactRecord>& contacts, const BodyConstants& body);

/// Those of a scene at its start. Takes one detection of contacts on the backend of the options; where its dynamics list none, that of
/// overlaps_as_rigid().
/// @throws InputError  what a run would be refused for
Overlaps find_overlaps(Scene scene, const WorldOptions& options);

/// The same as if all bodies were rigid: what lies inside a solid, or below a floor, crosses no surface, so not all models see it.
Overlaps overlaps_as_rigid(Scene scene, const WorldOptions& options);

/// A body as its scene file lists it, such as "bodies[3]" or "particles[0] #12"; by its id when the
/// scene comes from no file.
std::string body_name(const BodyConstants& body, int id);
/// The same with its id, or "the world".
std::string body_with_id(const BodyConstants& body, int id);

/// One line for a user, empty when there are none.
std::string overlap_warning(const Overlaps& overlaps, const BodyConstants& body);

}  // namespace scree
