#include "host/scene/stored_joints.h"

#include <fmt/format.h>

#include <cmath>

#include "host/error.h"
#include "host/scene/joint_cards.h"

namespace scree {
namespace {

/// What drives a joint; null: nothing.
const char* drive_name(const Joint& joint) {
  if (joint.kind == JointKind::cable) return "is a cable";
  if (joint.kind == JointKind::spring) return "is a spring";
  if (joint.motor) return "has a motor";
  if (joint.friction > 0) return "has friction";
  if (std::isfinite(joint.limits[0]) || std::isfinite(joint.limits[1])) return "has limits";
  return nullptr;
}

}  // namespace

void require_storable_joints(const std::string& where, const Scene& scene) {
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    if (const char* drive = drive_name(scene.joints[k]); drive != nullptr)
      throw InputError(fmt::format(
          "{}: joints[{}] ({}) {}, which files of contact problems do not hold; expected "
          "joints without limits, motors and friction, and no cables and springs",
          where, k, joint_card(scene.joints[k].kind).name, drive));
}

}  // namespace scree
