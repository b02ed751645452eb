#pragma once
// Brings together what ranks have of a simulation: states, contacts, forces, reports.

#include <functional>
#include <type_traits>
#include <vector>

#include "dynamics/ranks/decomposition.h"
#include "host/world.h"
#include "kernels/backend/ranks.h"

namespace scree {

/// Places of the free bodies that are there first, for the cut of space that a run starts with.
std::vector<WorkSample> work_samples(const Scene& scene);
/// Places of bodies, all of the same weight.
std::vector<WorkSample> work_samples(const std::vector<Vec3d>& positions);

/// Rank 0 gets the rows of all owned bodies. @param owned  ids of those here  @param states  of all bodies, by id
void gather_states(Ranks& ranks, const std::vector<std::int32_t>& owned, BodyStates& states);

/// Rank 0 gets the rows of all ranks, in their order.
template <class T>
void gather_rows(Ranks& ranks, std::vector<T>& rows) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const unsigned char*>(rows.data());
  const std::vector<Bytes> all =
      gather_bytes_at(ranks, Bytes(bytes, bytes + rows.size() * sizeof(T)), 0);
  if (ranks.rank() != 0) return;
  rows.clear();
  for (const Bytes& of_rank : all) {
    const auto* first = reinterpret_cast<const T*>(of_rank.data());
    rows.insert(rows.end(), first, first + of_rank.size() / sizeof(T));
  }
}

/// Every rank gets the rows of all ranks for each array, in their order.
WorldState gather_arrays(Ranks& ranks, const WorldState& own);
/// Sums of an array of vectors over ranks, everywhere.
void add_array(Ranks& ranks, const char* name, WorldState& state);

/// The part of a state of bodies and contacts that a rank needs: the bodies whose places it owns, and their contacts.
WorldState shared_part(const WorldState& state, const std::function<bool(const Vec3d&)>& owns);
/// Only the arrays of contacts.
WorldState contacts_of(const WorldState& state);
/// Checks that the arrays of a state have a row for each body and for each contact. @param vectors  of an impulse
/// @throws InputError naming the array
void require_rows(const WorldState& state, std::size_t bodies, std::size_t vectors);

/// Sums over ranks, everywhere.
void add_over_ranks(Ranks& ranks, MeanForces& means);
ForceRecord added_over_ranks(Ranks& ranks, const ForceRecord& own);

/// What a report says of bodies and of the worst contact becomes that of all ranks.
/// @param own_ghosts  of this rank
/// @param own_max     largest residual of the contacts here, whose bodies the report names [m/s]
void add_report(Ranks& ranks, std::int64_t own_ghosts, double own_max, StepReport& report);

}  // namespace scree
