#pragma once
// The joints of a scene in the frames of their bodies.

#include <vector>

#include "host/scene.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// The joints of a scene, in its order, from the poses of bodies at time zero. Where space repeats, the anchor of a body is the image
/// nearest to it. Behind them the drives about the axes of cylindrical joints, where there are some: the force along an axis and the
/// moment about it are both last rows, see JointRow, and a joint has one.
std::vector<JointFrames> joint_frames(const Scene& scene);
/// How many these are.
std::size_t joint_frame_count(const Scene& scene);

}  // namespace scree
