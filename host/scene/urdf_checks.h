#pragma once
// What is wrong with how a scene places a URDF model.

#include <optional>
#include <string>

#include "host/urdf.h"
#include "shapes/shape_card.h"

namespace scree {

/// The first of motors, positions and links that the model does not have or allow; the field is its path.
std::optional<Fault> placement_fault(const UrdfModel& model, const UrdfPlacement& placement);

/// Key of what a motor of the joint of that name gives whatever its speed; null: no such joint has a motor.
const char* urdf_motor_key(const UrdfModel& model, const std::string& name);

}  // namespace scree
