#pragma once
// How a run is going to use backend memory.

#include "host/world.h"

namespace scree {

/// Whether the list of near pairs of bodies stays in memory between steps, which makes steps
/// faster: when the run then takes half of the memory there is or less, and what is free.
bool keeps_near_pairs(const Scene& scene, const WorldOptions& options);

/// Expected memory of a body at the fullest, its contacts included [bytes].
/// @param near_pairs  with the list of near pairs kept
double expected_bytes_per_body(const Scene& scene, const WorldOptions& options, bool near_pairs);

/// As require_memory(), for so many bodies of so many bytes.
void require_memory_for(double bodies, double bytes_per_body, const WorldOptions& options);

}  // namespace scree
