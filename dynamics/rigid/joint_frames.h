#pragma once
// The joints of a scene in the frames of their bodies.

#include <vector>

#include "host/scene.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// What acts along or about the axis of a joint.
JointDrive drive_of(const Joint& joint);

/// The joints of a scene, in its order, from the poses of bodies at time zero. Where space repeats, the anchor of a body is the image
/// nearest to it.
std::vector<JointFrames> joint_frames(const Scene& scene);

}  // namespace scree
