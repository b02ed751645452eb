#pragma once
// Rank 0 leads: what it calls of its simulation, the others call of theirs.

#include <functional>
#include <memory>

#include "dynamics/dynamics.h"
#include "kernels/backend/ranks.h"

namespace scree {

using MakeDynamics = std::function<std::unique_ptr<Dynamics>()>;
/// Whether this rank was asked to end, by a signal.
using AsksToEnd = std::function<bool()>;

/// On rank 0: a simulation whose calls the others follow, which are in follow().
/// @throws what `make` throws, here or on another rank
std::unique_ptr<Dynamics> lead(std::shared_ptr<Ranks> ranks, const MakeDynamics& make);

/// On the ranks above: makes simulations and calls them as rank 0 does, until release(). A failure that only this rank has
/// ends all ranks.
/// @param sink  for Dynamics::give_own_bodies(); may be null
/// @param asks  rank 0 hears of it with its next call, see Dynamics::is_asked_to_end(); may be empty
void follow(Ranks& ranks, const MakeDynamics& make, OwnBodiesSink* sink, const AsksToEnd& asks);

/// On rank 0: ends follow() on the others.
void release(Ranks& ranks);

}  // namespace scree
