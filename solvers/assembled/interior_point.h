#pragma once
// The interior point method for problems whose bodies have very different masses.

#include "solvers/assembled/assembled_monitor.h"

namespace scree {

/// Impulses over loads up to which the method does not suspect that they grow without bound.
inline constexpr double kLeastGrowth = 1e6;

/// Runs the method as its solver does.
/// @param least_growth  kLeastGrowth; more where light bodies carry heavy ones, whose impulses are
///                      large for the loads of the light ones
void run_interior_point(const AssembledProblem& problem, const AssembledOptions& options,
                        double least_growth, AssembledMonitor& monitor);

}  // namespace scree
