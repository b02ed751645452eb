#pragma once
// What is wrong with how a scene places a URDF model.

#include <optional>

#include "host/urdf.h"
#include "shapes/shape_card.h"

namespace scree {

/// The first of motors, positions and links that the model does not have or allow; the field is its path.
std::optional<Fault> placement_fault(const UrdfModel& model, const UrdfPlacement& placement);

}  // namespace scree
