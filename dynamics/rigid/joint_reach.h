#pragma once
// How far bodies that joints hold together may be apart.

#include <vector>

#include "host/scene.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// Of each joint, the diameters of the free bodies that joints hold to its own ones, all together [m]: what turns with it is no
/// farther away.
/// @param frames  of the joints of the scene
std::vector<double> joint_reaches(const Scene& scene, const std::vector<JointFrames>& frames);

}  // namespace scree
