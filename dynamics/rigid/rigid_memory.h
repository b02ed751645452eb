#pragma once
// How a run of rigid bodies is going to use backend memory.

#include "host/world.h"

namespace scree {

/// Whether the list of near pairs of bodies stays in memory between steps, which makes steps
/// faster: when the run then takes half of the memory there is or less, and what is free.
bool keeps_near_pairs(const Scene& scene, const WorldOptions& options);

/// Expected memory of a body at the fullest, its contacts included [bytes].
double rigid_bytes_per_body(const Scene& scene, const WorldOptions& options);
/// The same without the list of near pairs.
double least_rigid_bytes_per_body(const Scene& scene, const WorldOptions& options);

}  // namespace scree
