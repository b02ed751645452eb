#pragma once
// How far joints let each other move.

#include <vector>

#include "host/scene.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// Of each joint with a spring, the part of the mobility of its row that the joints about it leave, where the scene begins: how much velocity
/// an impulse along the row gives it with them, over that without them. Near 0 where a light body is held to heavy ones, 1 where nothing
/// else holds its bodies, where they let it move by nothing at all, and of joints without a spring. Joints farther than the
/// nearest 24 are left out: what they hold counts as loose.
/// @param frames  of the joints of the scene, in its order; shares of their drives do not matter
std::vector<double> mobility_shares(const Scene& scene, const std::vector<JointFrames>& frames);

}  // namespace scree
