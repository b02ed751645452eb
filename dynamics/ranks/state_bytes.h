#pragma once
// A state on its way from one rank to another.

#include "host/world_state.h"
#include "kernels/backend/ranks.h"

namespace scree {

Bytes to_bytes(const WorldState& state);
/// @throws RunError when they are not those of to_bytes()
WorldState state_from(const Bytes& bytes);

}  // namespace scree
