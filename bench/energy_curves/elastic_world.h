#pragma once
// One elastic body above a floor, as time steps of a World see it.

#include <functional>

#include "bench/energy_curves/trace.h"
#include "host/world.h"

namespace scree::bench {

inline constexpr double kWeight = 9.81;  ///< g [m/s^2]; bodies have 1 kg

/// Energy over the steps of a World in which a body of 1 kg falls on a floor, without friction and with restitution 1. Steps
/// change velocities first: in free flight the energy with the mean of the velocities before and after a node is the one
/// that stays, so that one is taken.
/// @param floor    its height [m]
/// @param lowest   height of the lowest point of the body [m]
EnergyTrace world_trace(const RunLength& length, const BodyDescription& body, double floor,
                        const std::function<double(Vec3d position, Quatd orientation)>& lowest);

}  // namespace scree::bench
