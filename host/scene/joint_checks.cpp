// What joints may hold, and what scenes with joints may not have.

#include <fmt/format.h>

#include <cmath>

#include "dynamics/dynamics_card.h"
#include "host/scene/joint_cards.h"
#include "host/scene/scene_checks.h"
#include "kernels/bodies/range.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

constexpr double kHalfTurn = 3.14159265358979324;

double angle_between(const Vec3d& x, const Vec3d& y) {
  return std::atan2(norm(cross(x, y)), dot(x, y));
}

/// Forces, stiffness and speeds of joints are far below this.
constexpr double kLargestOfJoint = 1e15;

std::optional<Fault> point_fault(const char* field, const Vec3d& point) {
  if (is_finite(point) && is_in_range(point)) return std::nullopt;
  return Fault{field, vector_text(point),
               fmt::format("must be three numbers from {:g} to {:g} [m]", -kFarthest, kFarthest)};
}

std::optional<Fault> direction_fault(const char* field, const Vec3d& direction) {
  if (std::abs(norm(direction) - 1) <= 1e-6) return std::nullopt;
  return Fault{field, vector_text(direction), "must have length 1"};
}

/// Points, axes and length.
std::optional<Fault> geometry_fault(const Joint& joint) {
  const JointCard& card = joint_card(joint.kind);
  if (auto fault = point_fault(card.has_two_points ? "anchors[0]" : "anchor", joint.anchor))
    return fault;
  if (card.axis != nullptr && (!card.axis_is_optional || is_about_axis(joint)))
    if (auto fault = direction_fault("axis", joint.axis)) return fault;
  if (card.second_axis != nullptr) {
    if (auto fault = direction_fault("second_axis", joint.second_axis)) return fault;
    if (!(std::abs(dot(joint.axis, joint.second_axis)) <= 1e-6))
      return Fault{
          "second_axis", vector_text(joint.second_axis),
          fmt::format("must be at a right angle to `axis`, which is {}", vector_text(joint.axis))};
  }
  if (!card.has_two_points) return std::nullopt;
  if (auto fault = point_fault("anchors[1]", joint.second_anchor)) return fault;
  if (!(joint.length <= kFarthest))
    return Fault{
        "length", fmt::format("{:g}", joint.length),
        fmt::format("must be up to {:g} [m], or negative for that at the start", kFarthest)};
  const double length = joint.length < 0 ? norm(joint.second_anchor - joint.anchor) : joint.length;
  const bool has_direction = joint.kind == JointKind::distance || joint.kind == JointKind::cable;
  if (has_direction && !(length > 0))
    return Fault{"anchors", "one point twice",
                 "a distance of zero has no direction; use a ball joint"};
  return std::nullopt;
}

/// What is not from zero up to the largest value that runs compute with.
std::optional<Fault> amount_fault(const std::string& field, double value, bool may_be_zero,
                                  bool may_be_infinite) {
  const bool is_large_enough = value > 0 || (may_be_zero && value == 0);
  if (is_large_enough && (value <= kLargestOfJoint || (may_be_infinite && std::isinf(value))))
    return std::nullopt;
  return Fault{field, fmt::format("{:g}", value),
               fmt::format("must be {} and up to {:g}",
                           may_be_zero ? "zero or positive" : "positive", kLargestOfJoint)};
}

/// @param path       of the motor
/// @param force_key  of its moment or force
std::optional<Fault> motor_fault(const JointMotor& motor, const std::string& path,
                                 const char* force_key) {
  const std::string force = path + "." + force_key;
  for (const auto& [key, value] :
       {std::pair{path + ".speed", motor.speed}, std::pair{path + ".position", motor.position},
        std::pair{force, motor.force.value_or(0)}})
    if (!(std::abs(value) <= kLargestOfJoint))
      return Fault{key, fmt::format("{:g}", value),
                   fmt::format("must be from {:g} to {:g}", -kLargestOfJoint, kLargestOfJoint)};
  if (motor.force) {
    const bool is_alone = motor.speed == 0 && motor.position == 0 && motor.stiffness == 0 &&
                          std::isinf(motor.max_force);
    if (!is_alone)
      return Fault{force, fmt::format("{:g}", *motor.force),
                   "must be without speed, position, stiffness and max_force: a motor has one law"};
  }
  if (auto fault = amount_fault(path + ".stiffness", motor.stiffness, true, false)) return fault;
  if (auto fault = amount_fault(path + ".damping", motor.damping, true, false)) return fault;
  return amount_fault(path + ".max_force", motor.max_force, false, true);
}

/// Limits, motor and friction of one axis. @param prefix  of their keys
std::optional<Fault> axis_fault(const AxisDrive& drive, const std::string& prefix,
                                const char* force_key) {
  const auto [low, high] = drive.limits;
  if (!(low <= high))
    return Fault{prefix + "limits", fmt::format("[{:g}, {:g}]", low, high),
                 "must be two numbers, the lower one first"};
  if (drive.motor)
    if (auto fault = motor_fault(*drive.motor, prefix + "motor", force_key)) return fault;
  return amount_fault(prefix + "friction", drive.friction, true, false);
}

/// The cone of a ball joint.
std::optional<Fault> swing_fault(const Joint& joint) {
  const JointCard& card = joint_card(joint.kind);
  const bool has_swing = !std::isinf(joint.swing) || joint.swing < 0;
  if (!card.has_swing) {
    if (!has_swing && !joint.swing_axis) return std::nullopt;
    return Fault{"type", fmt::format("\"{}\" with a swing", card.name), "a ball joint can have it"};
  }
  if (joint.swing_axis) {
    if (auto fault = direction_fault("swing_axis", *joint.swing_axis)) return fault;
    if (std::abs(angle_between(joint.axis, *joint.swing_axis)) > kMostSwingAboutAxis)
      return Fault{"swing_axis", vector_text(*joint.swing_axis),
                   fmt::format("must be {:g} rad from `axis` at most, which is {}",
                               kMostSwingAboutAxis, vector_text(joint.axis))};
  }
  if (has_swing && !(joint.swing > 0 && joint.swing <= kHalfTurn))
    return Fault{"swing", fmt::format("{:g}", joint.swing),
                 "must be an angle above 0 and up to 3.14159 [rad]"};
  const bool needs_swing = has_limits(joint.drive()) || joint.motor;
  if (needs_swing && !(joint.swing <= kMostSwingAboutAxis))
    return Fault{"swing", has_swing ? fmt::format("{:g}", joint.swing) : "none",
                 fmt::format("must be up to {:g} [rad] beside limits or a motor: where the axes of "
                             "the bodies are opposite, there is no angle about them",
                             kMostSwingAboutAxis)};
  return std::nullopt;
}

/// Limits, motor, friction, spring and strength.
std::optional<Fault> drive_fault(const Joint& joint) {
  const JointCard& card = joint_card(joint.kind);
  const std::string kind = fmt::format("\"{}\"", card.name);
  if (card.drive == nullptr && has_drive(joint.drive()))
    return Fault{"type", kind + " with limits, a motor or friction",
                 "a hinge, a ball joint, a slider, a cylindrical or a universal joint can have "
                 "these"};
  if (!card.has_turn && has_drive(joint.turn))
    return Fault{"type", kind + " with a turn", "a cylindrical joint can have it"};
  if (!card.has_second_turn && has_drive(joint.second_turn))
    return Fault{"type", kind + " with a second turn", "a universal joint can have it"};
  if (auto fault = axis_fault(joint.drive(), "", card.drive)) return fault;
  if (auto fault = axis_fault(joint.turn, "turn.", kTurnDrive)) return fault;
  if (auto fault = axis_fault(joint.second_turn, "second_turn.", kTurnDrive)) return fault;
  if (auto fault = swing_fault(joint)) return fault;
  if (auto fault = amount_fault("stiffness", joint.stiffness, true, false)) return fault;
  if (auto fault = amount_fault("damping", joint.damping, true, false)) return fault;
  if (joint.kind == JointKind::spring && joint.stiffness == 0 && joint.damping == 0)
    return Fault{"stiffness", "0 without damping", "a spring must pull or damp"};
  if (auto fault = amount_fault("break_force", joint.break_force, false, true)) return fault;
  if (card.has_two_points && !std::isinf(joint.break_moment))
    return Fault{"break_moment", fmt::format("{:g} of a \"{}\"", joint.break_moment, card.name),
                 "between two points no moment acts; take break_force"};
  const bool carries_moment = is_about_axis(joint) || has_drive(joint.drive());
  if (joint.kind == JointKind::ball && !carries_moment && !std::isinf(joint.break_moment))
    return Fault{"break_moment", fmt::format("{:g} of a \"ball\"", joint.break_moment),
                 "a ball joint without swing, limits, a motor and friction carries no moment; take "
                 "break_force"};
  return amount_fault("break_moment", joint.break_moment, false, true);
}

/// Two points are held at the images nearest to each other, which are never farther apart than half a period.
std::optional<Fault> length_fault(const Scene& scene, const Joint& joint) {
  const Periodicity& space = scene.periodicity;
  for (int k = 0; k < 3; ++k) {
    const double half = 0.5 * (space.upper[k] - space.lower[k]);
    if (space.periodic[static_cast<std::size_t>(k)] && joint.length >= half)
      return Fault{"length", fmt::format("{:g}", joint.length),
                   fmt::format("must be less than half of the period, {:g} [m]", half)};
  }
  return std::nullopt;
}

/// Where space repeats, a body is held at the image of its point nearest to it: what a joint measures along its axis, or between two
/// points, goes no farther than half a period.
std::optional<Fault> period_fault(const Scene& scene, const Joint& joint) {
  if (joint_card(joint.kind).has_two_points) return length_fault(scene, joint);
  if (joint.kind != JointKind::slider && joint.kind != JointKind::cylindrical) return std::nullopt;
  const Periodicity& space = scene.periodicity;
  for (int k = 0; k < 3; ++k) {
    const double along = std::abs(joint.axis[k]);
    constexpr double kStraight = 1e-6;
    if (!space.periodic[static_cast<std::size_t>(k)] || along < kStraight) continue;
    const double half = 0.5 * (space.upper[k] - space.lower[k]);
    if (along < 1 - kStraight)
      return Fault{"axis", vector_text(joint.axis),
                   "must be along a direction in which space repeats, or across it"};
    const auto [low, high] = joint.limits;
    for (const double limit : {low, high})
      if (!std::isinf(limit) && !(std::abs(limit) < half))
        return Fault{"limits", fmt::format("[{:g}, {:g}]", low, high),
                     fmt::format("must be nearer than half of the period, {:g} [m]", half)};
    if (joint.motor && joint.motor->stiffness > 0 && !(std::abs(joint.motor->position) < half))
      return Fault{"motor.position", fmt::format("{:g}", joint.motor->position),
                   fmt::format("must be nearer than half of the period, {:g} [m]", half)};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Fault> joint_fault(const Scene& scene, const Joint& joint) {
  const int count = static_cast<int>(scene.bodies.size());
  bool has_free = false;
  for (std::size_t k = 0; k < 2; ++k) {
    const int id = joint.bodies[k];
    if (id != kWorldBody && (id < 0 || id >= count))
      return Fault{fmt::format("bodies[{}]", k), fmt::format("{}", id),
                   fmt::format("must be an index of `bodies` below {}, or the world", count)};
    has_free = has_free || (id != kWorldBody &&
                            scene.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free);
  }
  if (joint.bodies[0] == joint.bodies[1])
    return Fault{"bodies", "the same body twice", "must be two bodies"};
  if (!has_free)
    return Fault{"bodies", "a joint of two bodies that are not free",
                 "one of them must be free to follow the other"};
  if (auto fault = geometry_fault(joint)) return fault;
  if (auto fault = period_fault(scene, joint)) return fault;
  return drive_fault(joint);
}

std::optional<Fault> joints_fault(const Scene& scene) {
  if (scene.joints.empty()) return std::nullopt;
  const DynamicsCard& card = dynamics_card(scene.dynamics.type);
  if (!card.has_joints)
    return Fault{"joints", fmt::format("a list of {}", scene.joints.size()),
                 fmt::format("bodies of the dynamics \"{}\" cannot be joined", card.name)};
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    if (auto fault = joint_fault(scene, scene.joints[k]))
      return Fault{fmt::format("joints[{}].{}", k, fault->field), fault->value, fault->expected};
  return std::nullopt;
}

}  // namespace scree
