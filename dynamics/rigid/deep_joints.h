#pragma once
// Which joints are worth a direct solve on the host, beside a device that iterates.

#include <vector>

#include "host/scene.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// Joints of the islands that an impulse takes so many iterations to cross that the time of a direct solve on the host, with the
/// way there and back, is less: long chains, but not nets, whose factors fill up, nor thousands of short mechanisms. It depends on
/// nothing but which bodies joints connect.
/// @return  in ascending order
std::vector<Index> deep_joints(const Scene& scene, const std::vector<JointFrames>& frames);

}  // namespace scree
