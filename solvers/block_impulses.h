#pragma once
// Exact impulses of a small group of contacts, all others as they are.

#include <vector>

#include "kernels/solve/loaded_block.h"

namespace scree {

/// Impulses of the contacts, in world axes [N s], that solve the convex problem with the impulses
/// of all other contacts kept: by the interior point method, in double, on one thread of the host.
/// Empty when it finds none that are much better.
/// @param contrast   largest ratio of masses of bodies in contact
/// @param tolerance  RMS residual [m/s]
std::vector<Vec3<double>> block_impulses(const std::vector<BlockContact>& contacts, double contrast,
                                         double tolerance);

}  // namespace scree
