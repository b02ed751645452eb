#include "dynamics/rigid/joint_frames.h"

#include <array>
#include <limits>

#include "dynamics/rigid/collision_settings.h"
#include "dynamics/rigid/joint_mobility.h"
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
  JointDrive d = drive_of(joint.drive());
  if (joint.kind == JointKind::cable) d.upper = 0;
  if (joint.kind == JointKind::spring) {
    d.stiffness = joint.stiffness;
    d.damping = joint.damping;
    d.most = std::numeric_limits<double>::infinity();
  }
  return d;
}

/// The joint in the frames of its bodies, from their poses at time zero. Where space repeats, the
/// anchor of a body is the image nearest to it.
JointFrames frames_of(const Scene& scene, const Joint& joint) {
  JointFrames out;
  const Vec3d period = periodic_box(scene.periodicity).length;
  const JointCard& card = joint_card(joint.kind);
  const Quatd axes = card.axis != nullptr ? rotation_to(joint.axis) : Quatd{1, 0, 0, 0};
  for (int k = 0; k < 2; ++k) {
    const int id = joint.bodies[static_cast<std::size_t>(k)];
    const Vec3d anchor = k == 1 && card.has_two_points ? joint.second_anchor : joint.anchor;
    const Quatd own = k == 1 && card.second_axis != nullptr ? rotation_to(joint.second_axis) : axes;
    out.body[k] = id;
    out.anchor[k] = anchor;
    out.frame[k] = own;
    if (id == kWorldBody) continue;
    const BodyDescription& body = scene.bodies[static_cast<std::size_t>(id)];
    const Pose pose = pose_at(body, 0);
    const Quatd q = normalized(pose.orientation);
    out.anchor[k] = rotate_back(q, minimum_image(anchor - pose.position, period));
    out.frame[k] = conjugate(q) * own;
  }
  const RowsOfJoint& rows = rows_of_joint(joint.kind);
  out.form = rows.form;
  out.held = rows.held;
  out.drive = drive_along(joint);
  if (card.has_two_points)
    out.zero = joint.length < 0 ? norm(minimum_image(joint.second_anchor - joint.anchor, period))
                                : joint.length;
  out.break_force = joint.break_force;
  out.break_moment = joint.break_moment;
  return out;
}

/// The drive about the axis of a joint.
JointFrames turn_of(const JointFrames& joint, Index number, const AxisDrive& drive) {
  JointFrames out = joint;
  out.form = JointForm::turn;
  out.held = 0;
  out.drive = drive_of(drive);
  out.break_force = out.break_moment = std::numeric_limits<double>::infinity();
  out.turn_of = number;
  return out;
}

}  // namespace

std::vector<JointFrames> joint_frames(const Scene& scene) {
  std::vector<JointFrames> out;
  for (const Joint& joint : scene.joints) out.push_back(frames_of(scene, joint));
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    if (has_drive(scene.joints[j].turn))
      out.push_back(turn_of(out[j], static_cast<Index>(j), scene.joints[j].turn));
  const std::vector<double> share = mobility_shares(scene, out);
  for (std::size_t j = 0; j < out.size(); ++j) out[j].drive.share = share[j];
  return out;
}

std::size_t joint_frame_count(const Scene& scene) {
  std::size_t count = scene.joints.size();
  for (const Joint& joint : scene.joints) count += has_drive(joint.turn) ? 1 : 0;
  return count;
}

}  // namespace scree
