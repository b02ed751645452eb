#pragma once
// The kinds of joints: names in scene files, and what each of them asks for.

#include <array>
#include <cmath>

#include "host/scene.h"

namespace scree {

struct JointCard {
  JointKind kind;
  const char* name;
  const char* axis = nullptr;         ///< what its `axis` is; null: it has none
  bool axis_is_optional = false;      ///< needed only by what is about it, see is_about_axis()
  const char* second_axis = nullptr;  ///< the same of `second_axis`
  bool has_two_points = false;        ///< `anchors` and a length; else one `anchor` for both bodies
  /// Takes limits, friction and a motor, whose moment or force has this key; null: nothing of these.
  const char* drive = nullptr;
  bool has_turn = false;           ///< takes them about its axis too, as its `turn`
  bool has_second_turn = false;    ///< takes them about its second axis too, as its `second_turn`
  bool has_swing = false;          ///< takes a largest angle between an axis of each body
  const char* position = nullptr;  ///< unit of its way, null: it has none that is one number
};

inline constexpr std::array kJointCards{
    JointCard{.kind = JointKind::hinge,
              .name = "hinge",
              .axis = "a hinge needs the direction it turns about, [x, y, z]",
              .drive = "torque",
              .position = "rad"},
    JointCard{.kind = JointKind::ball,
              .name = "ball",
              .axis = "a ball joint needs the direction that its swing, limits and motor are "
                      "about, [x, y, z]",
              .axis_is_optional = true,
              .drive = "torque",
              .has_swing = true},
    JointCard{.kind = JointKind::fixed, .name = "fixed"},
    JointCard{.kind = JointKind::slider,
              .name = "slider",
              .axis = "a slider needs the direction it moves along, [x, y, z]",
              .drive = "force",
              .position = "m"},
    JointCard{.kind = JointKind::cylindrical,
              .name = "cylindrical",
              .axis = "a cylindrical joint needs the direction it moves along and turns about, "
                      "[x, y, z]",
              .drive = "force",
              .has_turn = true,
              .position = "m"},
    JointCard{.kind = JointKind::universal,
              .name = "universal",
              .axis = "a universal joint needs the axis of its cross in the first body, [x, y, z]",
              .second_axis = "a universal joint needs the axis of its cross in the second body, "
                             "[x, y, z]",
              .drive = "torque",
              .has_second_turn = true},
    JointCard{
        .kind = JointKind::distance, .name = "distance", .has_two_points = true, .position = "m"},
    JointCard{.kind = JointKind::cable, .name = "cable", .has_two_points = true, .position = "m"},
    JointCard{
        .kind = JointKind::spring, .name = "spring", .has_two_points = true, .position = "m"}};

/// Of a motor about an axis, as JointCard::drive.
inline constexpr const char* kTurnDrive = "torque";

/// Largest swing of a ball joint with limits or a motor about its axis: where the two axes are opposite, there is no angle about them [rad].
inline constexpr double kMostSwingAboutAxis = 3;

inline bool has_limits(const AxisDrive& drive) {
  return !std::isinf(drive.limits[0]) || !std::isinf(drive.limits[1]);
}

/// Whether there is anything.
inline bool has_drive(const AxisDrive& drive) {
  return has_limits(drive) || drive.motor || drive.friction != 0;
}

/// Whether something of a ball joint is about its axis.
inline bool is_about_axis(const Joint& joint) {
  return !std::isinf(joint.swing) || has_limits(joint.drive()) || joint.motor;
}

constexpr const JointCard& joint_card(JointKind kind) {
  for (const JointCard& card : kJointCards)
    if (card.kind == kind) return card;
  return kJointCards[0];
}

}  // namespace scree
