#pragma once
// What a mechanical system must be before it moves.

#include "host/collision_integrator.h"

namespace scree::variational {

/// @throws InputError that names what is wrong, its value and what was expected
void check_system(const MechanicalSystem& system, const ImpactSettings& settings,
                  const std::vector<double>& position, const std::vector<double>& velocity);

}  // namespace scree::variational
