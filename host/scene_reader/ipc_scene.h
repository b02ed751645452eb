#pragma once
// Scenes of rigid-ipc (github.com/ipc-sim/rigid-ipc) and of Autodesk's Affine Body Dynamics: one
// format, in which the second has angles in radians and joints. docs/user_guide.md, "Scenes of other
// programs".

#include <string>
#include <vector>

#include "host/scene.h"
#include "host/scene_reader/node.h"

namespace scree::ipc {

/// Whether a document is such a scene.
bool is_ipc_scene(const reader::Json& document);

/// The scene, for the dynamics "affine"; not yet checked.
/// @param notes  gets which dialect it was taken for, and what of it is not used
/// @throws InputError naming file, key, value and what was expected
Scene read_ipc_scene(const reader::Node& root, std::vector<std::string>& notes);

}  // namespace scree::ipc
