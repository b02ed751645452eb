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

/// Free bodies whose place is one of those that `here` names.
std::int64_t count_free_bodies(const std::vector<BodyDescription>& bodies,
                               const std::vector<ParticleSet>& sets,
                               const std::function<bool(const Vec3d&)>& here);

/// Rank 0 gets the rows of all owned bodies. @param owned  ids of those here  @param states  of all bodies, by id
void gather_states(Ranks& ranks, const std::vector<std::int32_t>& owned, BodyStates& states);

/// Rank 0 gets the rows of all ranks, in their order.
template <class T>
void gather_rows(Ranks& ranks, std::vector<T>& rows) {
  const std::vector<Bytes> all = gather_bytes_at(ranks, bytes_of(rows), 0);
  if (ranks.rank() != 0) return;
  rows.clear();
  for (const Bytes& of_rank : all) append_values(of_rank, rows);
}

/// Every rank gets the rows of all ranks for each array, in their order.
WorldState gather_arrays(Ranks& ranks, const WorldState& own);
/// Sums of an array of vectors over ranks, everywhere.
void add_array(Ranks& ranks, const char* name, WorldState& state);

/// Sums over ranks, everywhere.
void add_over_ranks(Ranks& ranks, MeanForces& means);
ForceRecord added_over_ranks(Ranks& ranks, const ForceRecord& own);

/// What a report says of bodies and of the worst contact becomes that of all ranks.
/// @param own_ghosts  of this rank
/// @param own_max     largest residual of the contacts here, whose bodies the report names [m/s]
/// @param is_fine     whether the report may stand, as far as this rank knows
/// @return            whether it may on all ranks
bool add_report(Ranks& ranks, std::int64_t own_ghosts, double own_max, bool is_fine,
                StepReport& report);

}  // namespace scree
