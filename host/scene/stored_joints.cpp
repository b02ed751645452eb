#include "host/scene/stored_joints.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "host/error.h"
#include "host/scene/joint_cards.h"

namespace scree {
namespace {

/// What drives a joint; empty: nothing.
std::string drive_of(const Joint& joint) {
  if (joint.kind == JointKind::cable) return "is a cable";
  if (joint.kind == JointKind::spring) return "is a spring";
  const char* has = nullptr;
  if (std::isfinite(joint.swing)) has = "limits";
  for (const AxisDrive& drive : {joint.drive(), joint.turn, joint.second_turn}) {
    if (has_limits(drive)) has = "limits";
    if (drive.friction > 0) has = "friction";
    if (drive.motor) has = "a motor";
  }
  return has == nullptr ? "" : fmt::format("({}) has {}", joint_card(joint.kind).name, has);
}

}  // namespace

void require_storable_joints(const std::string& where, const Scene& scene) {
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    if (const std::string drive = drive_of(scene.joints[k]); !drive.empty())
      throw InputError(
          fmt::format("{}: joints[{}] {}, which files of contact problems do not hold; expected "
                      "joints without limits, motors and friction, and no cables and springs",
                      where, k, drive));
}

}  // namespace scree
