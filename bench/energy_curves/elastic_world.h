#pragma once
// One elastic body above a floor, as time steps of a World see it.

#include <functional>

#include "bench/energy_curves/trace.h"
#include "host/world.h"

namespace scree::bench {

inline constexpr double kWeight = 9.81;  ///< g [m/s^2]; bodies have 1 kg

/// Energy over the steps of a World in which a body of 1 kg falls on a floor, without friction and with restitution 1. Steps
/// change velocities first: in free flight the mean of the velocities before and after a node is right, and the energy with it stays. So that
/// mean is taken, and it is the body's velocity at the start.
/// @param floor    its height [m]
/// @param lowest   height of the lowest point of the body [m]
/// @param exact    height of its center over time [m], where that is known
EnergyTrace world_trace(const RunLength& length, const BodyDescription& body, double floor,
                        const std::function<double(Vec3d position, Quatd orientation)>& lowest,
                        const std::function<double(double time)>& exact = {});

}  // namespace scree::bench
