#pragma once
// Joints that cannot do what a scene of affine bodies asks of them.

#include <string>
#include <vector>

#include "dynamics/affine/affine_setup.h"

namespace scree::affine {

/// Of joints that begin beyond their limits, and of motors without a bound whose way joints and locks hold.
std::vector<std::string> joint_warnings(const AffineSetup& setup, double time_step);

}  // namespace scree::affine
