#pragma once
// How fast motors whose force is known make what they drive.

#include <vector>

#include "host/scene.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// The speed that motors give in a step, as a load would: h F / m of the lighter of the two bodies, with the force, or the moment
/// over the radius of the smaller one, that each gives at most, or that a motor with a position gives where the scene begins; RMS
/// over the free bodies of the scene [m/s]. Motors that keep a speed without a bound are left out, and springs.
double motor_speed(const Scene& scene, const std::vector<JointFrames>& frames);

}  // namespace scree
