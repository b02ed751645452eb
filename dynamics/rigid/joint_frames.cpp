#include "dynamics/rigid/joint_frames.h"

#include <array>
#include <cmath>
#include <limits>

#include "dynamics/rigid/collision_settings.h"
#include "dynamics/rigid/joint_mobility.h"
#include "dynamics/rigid/joint_reach.h"
#include "host/scene/joint_cards.h"
#include "host/scene/motion.h"

namespace scree {
namespace {

/// What a kind of joint measures, and which of the rows it holds: bit k is row k of JointRow. Rows 0, 1
/// and 3, 4 are forces and moments across the axis; 2 and 5 along and about it, of forms that end
/// with a force the other way round.
struct RowsOfJoint {
  JointKind kind;
  JointForm form;
  unsigned held;
};
constexpr std::array kRowsOfJoints{RowsOfJoint{JointKind::hinge, JointForm::point, 0b011111},
                                   RowsOfJoint{JointKind::ball, JointForm::point, 0b000111},
                                   RowsOfJoint{JointKind::fixed, JointForm::point, 0b111111},
                                   RowsOfJoint{JointKind::slider, JointForm::slide, 0b011111},
                                   RowsOfJoint{JointKind::cylindrical, JointForm::slide, 0b011011},
                                   RowsOfJoint{JointKind::universal, JointForm::cross, 0b100111},
                                   RowsOfJoint{JointKind::distance, JointForm::line, 0b100000},
                                   RowsOfJoint{JointKind::cable, JointForm::line, 0},
                                   RowsOfJoint{JointKind::spring, JointForm::line, 0}};

constexpr const RowsOfJoint& rows_of_joint(JointKind kind) {
  for (const RowsOfJoint& rows : kRowsOfJoints)
    if (rows.kind == kind) return rows;
  return kRowsOfJoints[0];
}

JointDrive drive_of(const AxisDrive& drive) {
  JointDrive d;
  d.lower = drive.limits[0];
  d.upper = drive.limits[1];
  d.friction = drive.friction;
  if (drive.motor) {
    const JointMotor& motor = *drive.motor;
    d.stiffness = motor.stiffness;
    d.damping = motor.damping;
    d.target = motor.keeps_speed() ? motor.speed : motor.position;
    d.most = motor.most_beside_force();
    d.force = motor.force.value_or(0);
  }
  return d;
}

/// What acts on the last row of a joint.
JointDrive drive_along(const Joint& joint) {
  const JointCard& card = joint_card(joint.kind);
  if (card.has_swing) {
    JointDrive d;
    d.upper = joint.swing;
    d.lower = -joint.swing;  // on the other side, by way of no swing
    return d;
  }
  if (card.has_second_turn) return {};
  JointDrive d = drive_of(joint.drive());
  if (joint.kind == JointKind::cable) d.upper = 0;
  if (joint.kind == JointKind::spring) {
    d.stiffness = joint.stiffness;
    d.damping = joint.damping;
    d.most = std::numeric_limits<double>::infinity();
  }
  return d;
}

/// Axes of a joint in the world at time zero, of either body.
using JointAxes = std::array<Quatd, 2>;

/// The shortest rotation that takes one unit vector to another, which is not its opposite.
Quatd rotation_between(const Vec3d& from, const Vec3d& to) {
  const Vec3d c = cross(from, to);
  return normalized(Quatd{1 + dot(from, to), c.x, c.y, c.z});
}

JointAxes axes_of(const Joint& joint) {
  const JointCard& card = joint_card(joint.kind);
  const bool has_axis = card.axis != nullptr && (!card.axis_is_optional || is_about_axis(joint));
  const Quatd first = has_axis ? rotation_to(joint.axis) : Quatd{1, 0, 0, 0};
  if (card.second_axis != nullptr) return {first, rotation_to(joint.second_axis)};
  if (has_axis && joint.swing_axis)
    return {first, rotation_between(joint.axis, *joint.swing_axis) * first};
  return {first, first};
}

/// Axes that begin together: the last one along `axis`, the first one along `across`, which is at a right angle to it.
JointAxes axes_along(const Vec3d& axis, const Vec3d& across) {
  const Quatd some = rotation_to(axis);
  const Vec3d x = rotate(some, {1, 0, 0});
  const Quatd both = exp_map(std::atan2(dot(axis, cross(x, across)), dot(x, across)) * axis) * some;
  return {both, both};
}

void set_axes(const Scene& scene, const JointAxes& axes, JointFrames& out) {
  for (std::size_t k = 0; k < 2; ++k) {
    const Index id = out.body[k];
    out.frame[k] = id == kWorldId
                       ? axes[k]
                       : conjugate(normalized(
                             pose_at(scene.bodies[static_cast<std::size_t>(id)], 0).orientation)) *
                             axes[k];
  }
}

/// The joint in the frames of its bodies, from their poses at time zero. Where space repeats, the
/// anchor of a body is the image nearest to it.
JointFrames frames_of(const Scene& scene, const Joint& joint) {
  JointFrames out;
  const Vec3d period = periodic_box(scene.periodicity).length;
  const JointCard& card = joint_card(joint.kind);
  for (int k = 0; k < 2; ++k) {
    const int id = joint.bodies[static_cast<std::size_t>(k)];
    const Vec3d anchor = k == 1 && card.has_two_points ? joint.second_anchor : joint.anchor;
    out.body[k] = id;
    out.anchor[k] = anchor;
    if (id == kWorldBody) continue;
    const Pose pose = pose_at(scene.bodies[static_cast<std::size_t>(id)], 0);
    out.anchor[k] =
        rotate_back(normalized(pose.orientation), minimum_image(anchor - pose.position, period));
  }
  set_axes(scene, axes_of(joint), out);
  const RowsOfJoint& rows = rows_of_joint(joint.kind);
  out.form = std::isinf(joint.swing) ? rows.form : JointForm::swing;
  out.held = rows.held;
  out.drive = drive_along(joint);
  if (card.has_two_points)
    out.zero = joint.length < 0 ? norm(minimum_image(joint.second_anchor - joint.anchor, period))
                                : joint.length;
  out.break_force = joint.break_force;
  out.break_moment = joint.break_moment;
  return out;
}

/// What acts about an axis of a joint beside its last row.
struct Turn {
  JointForm form;
  AxisDrive drive;
};

std::vector<Turn> turns_of(const Joint& joint) {
  std::vector<Turn> out;
  const auto add = [&](JointForm form, const AxisDrive& drive) {
    if (has_drive(drive)) out.push_back({form, drive});
  };
  if (joint.kind == JointKind::universal) add(JointForm::turn, joint.drive());
  if (joint.kind == JointKind::ball) {
    add(JointForm::twist, {joint.limits, joint.motor, 0});
    add(JointForm::rub, {.friction = joint.friction});
  }
  add(JointForm::turn, joint.turn);
  add(JointForm::second_turn, joint.second_turn);
  return out;
}

JointFrames frames_of_turn(const Scene& scene, Index number, const JointFrames& own,
                           const Turn& turn) {
  const Joint& joint = scene.joints[static_cast<std::size_t>(number)];
  JointFrames out = own;
  out.form = turn.form;
  out.held = 0;
  out.drive = drive_of(turn.drive);
  out.break_force = out.break_moment = std::numeric_limits<double>::infinity();
  out.turn_of = number;
  if (joint.kind != JointKind::universal) return out;
  const bool is_second = turn.form == JointForm::second_turn;
  set_axes(scene,
           is_second ? axes_along(joint.second_axis, joint.axis)
                     : axes_along(joint.axis, joint.second_axis),
           out);
  return out;
}

}  // namespace

std::vector<JointFrames> joint_frames(const Scene& scene) {
  std::vector<JointFrames> out;
  for (const Joint& joint : scene.joints) out.push_back(frames_of(scene, joint));
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    for (const Turn& turn : turns_of(scene.joints[j]))
      out.push_back(frames_of_turn(scene, static_cast<Index>(j), out[j], turn));
  const std::vector<double> share = mobility_shares(scene, out);
  const std::vector<double> reach = joint_reaches(scene, out);
  for (std::size_t j = 0; j < out.size(); ++j) {
    out[j].drive.share = share[j];
    out[j].reach = reach[j];
  }
  return out;
}

std::size_t joint_frame_count(const Scene& scene) {
  std::size_t count = scene.joints.size();
  for (const Joint& joint : scene.joints) count += turns_of(joint).size();
  return count;
}

}  // namespace scree
