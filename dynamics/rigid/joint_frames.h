#pragma once
// The joints of a scene in the frames of their bodies.

#include <vector>

#include "host/scene.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// The joints of a scene, in its order, from the poses of bodies at time zero. Where space repeats, the anchor of a body is the image
/// nearest to it. Behind them, joint by joint, what drives them about other axes: about those of cylindrical and universal joints,
/// the twist and the friction of ball joints. Each is a last row, see JointRow, of which a joint has one, or all its moments.
std::vector<JointFrames> joint_frames(const Scene& scene);
/// How many these are.
std::size_t joint_frame_count(const Scene& scene);

}  // namespace scree
