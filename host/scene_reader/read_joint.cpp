// Entries of `joints`: which bodies, where, and what they leave free.

#include <fmt/format.h>

#include "host/scene/joint_cards.h"
#include "host/scene/scene_checks.h"
#include "host/scene_reader/parts.h"

namespace scree::reader {
namespace {

/// Entry of `bodies` that a name or a number stands for.
std::size_t entry_of(const Node& node, const Draft& draft) {
  const std::size_t count = draft.body_of_entry.size();
  if (!node.json().is_string()) {
    if (count == 0) node.refuse("must be a name or \"world\": the scene has no `bodies`");
    return static_cast<std::size_t>(node.integer(0, static_cast<long long>(count) - 1));
  }
  const std::string name = node.text();
  const auto found = draft.entry_of_name.find(name);
  if (found != draft.entry_of_name.end()) return found->second;
  std::vector<std::string> known{kWorldName};
  for (const auto& [other, entry] : draft.entry_of_name) known.push_back(other);
  for (const auto& [other, body] : draft.scene.body_names) known.push_back(other);
  node.refuse(
      "must be the `name` of one of `bodies`, its number in that list from 0, or \"world\"" +
      nearest_hint(name, known));
}

[[noreturn]] void refuse_key(const Node& value, const JointCard& card) {
  value.fail(fmt::format("a joint of type \"{}\" has no such key", card.name));
}

/// The key that a kind of joint has, null where it has none.
void read_direction(const Node& node, const JointCard& card, const char* key, const char* what,
                    Vec3d& direction) {
  if (what != nullptr) {
    direction = node.at(key, what).direction();
  } else if (const auto value = node.find(key)) {
    refuse_key(*value, card);
  }
}

/// Axes of the bodies; that of a ball joint is there where it is asked for.
void read_axes(const Node& node, const JointCard& card, Joint& joint) {
  bool is_needed = !card.axis_is_optional;
  for (const char* key : {"swing", "swing_axis", "limits", "motor", "axis"})
    is_needed = is_needed || node.find(key);
  if (is_needed) read_direction(node, card, "axis", card.axis, joint.axis);
  read_direction(node, card, "second_axis", card.second_axis, joint.second_axis);
  for (const char* key : {"swing", "swing_axis"})
    if (const auto value = node.find(key); value && !card.has_swing) refuse_key(*value, card);
  node.read("swing", joint.swing, kPositive, "rad");
  if (const auto other = node.find("swing_axis")) joint.swing_axis = other->direction();
}

void read_anchors(const Node& node, const JointCard& card, Joint& joint) {
  if (const auto other = node.find(card.has_two_points ? "anchor" : "anchors"))
    refuse_key(*other, card);
  if (!card.has_two_points) {
    joint.anchor =
        node.at("anchor", "must be a point of both bodies at the start, [x, y, z] [m]").vector("m");
    return;
  }
  const char* const two =
      "must be two points at the start, of the first and of the second body, [[x, y, z], "
      "[x, y, z]] [m]";
  const Node anchors = node.at("anchors", two);
  const std::vector<Node> ends = anchors.elements();
  if (ends.size() != 2) anchors.refuse(two);
  joint.anchor = ends[0].vector("m");
  joint.second_anchor = ends[1].vector("m");
}

/// Limits, motor and friction of one axis.
AxisDrive read_axis(const Node& node, const char* force_key) {
  AxisDrive drive;
  if (const auto limits = node.find("limits")) {
    const auto [low, high] = limits->interval("rad, or m");
    drive.limits = {low, high};
  }
  if (const auto motor = node.find("motor")) drive.motor = read_joint_motor(*motor, force_key);
  node.read("friction", drive.friction, kNonNegative, "N m, or N");
  return drive;
}

/// The same of another axis, where a kind of joint has one.
void read_turn(const Node& node, const JointCard& card, const char* key, bool has_it,
               AxisDrive& drive) {
  const auto turn = node.find(key);
  if (!turn) return;
  if (!has_it) refuse_key(*turn, card);
  turn->check_keys(scene_keys("joint_turn"));
  drive = read_axis(*turn, kTurnDrive);
}

/// What moves and holds a joint along or about its axis.
void read_drive(const Node& node, const JointCard& card, Joint& joint) {
  if (card.drive == nullptr)
    for (const char* key : {"limits", "motor", "friction"})
      if (const auto value = node.find(key)) refuse_key(*value, card);
  if (!card.has_two_points)
    if (const auto value = node.find("length")) refuse_key(*value, card);
  if (card.kind != JointKind::spring)
    for (const char* key : {"stiffness", "damping"})
      if (const auto value = node.find(key)) refuse_key(*value, card);
  if (card.drive != nullptr) {
    const AxisDrive own = read_axis(node, card.drive);
    joint.limits = own.limits;
    joint.motor = own.motor;
    joint.friction = own.friction;
  }
  read_turn(node, card, "turn", card.has_turn, joint.turn);
  read_turn(node, card, "second_turn", card.has_second_turn, joint.second_turn);
  node.read("length", joint.length, card.kind == JointKind::spring ? kNonNegative : kPositive, "m");
  if (card.kind == JointKind::spring)
    joint.stiffness = node.at("stiffness", "must be that of the spring [N/m], or 0 for a damper")
                          .number(kNonNegative, "N/m");
  node.read("damping", joint.damping, kNonNegative, "N s/m");
  node.read("break_force", joint.break_force, kPositive, "N");
  node.read("break_moment", joint.break_moment, kPositive, "N m");
}

}  // namespace

int read_held_body(const Node& node, const Draft& draft) {
  if (node.json().is_string()) {
    if (node.text() == kWorldName) return kWorldBody;
    const auto of_model = draft.scene.body_names.find(node.text());  // those of `urdf` so far
    if (of_model != draft.scene.body_names.end()) return of_model->second;
  }
  const int body = draft.body_of_entry[entry_of(node, draft)];
  if (body == kInserted) node.refuse("must be there from the start, without insert_at");
  return body;
}

JointMotor read_joint_motor(const Node& node, const std::string& force_key) {
  node.check_keys(scene_keys("joint_motor"));
  JointMotor motor;
  for (const char* key : {"torque", "force"})
    if (const auto other = node.find(key); other && key != force_key)
      other->fail(fmt::format("a motor of this joint has no such key, it has \"{}\"", force_key));
  if (const auto force = node.find(force_key)) {
    for (const char* key : {"speed", "position", "stiffness", "max_force"})
      if (const auto other = node.find(key))
        other->fail(fmt::format("a motor with \"{}\" has no such key", force_key));
    motor.force = force->number(kFinite, "N m, or N");
    node.read("damping", motor.damping, kNonNegative, "N m s/rad, or N s/m");
    return motor;
  }
  const auto speed = node.find("speed"), position = node.find("position");
  if (speed.has_value() == position.has_value())
    node.fail(
        fmt::format("must have either \"speed\", or \"position\" with \"stiffness\" and "
                    "\"damping\", or \"{}\"",
                    force_key));
  if (speed) {
    for (const char* key : {"stiffness", "damping"})
      if (const auto other = node.find(key))
        other->fail("a motor with \"speed\" has no such key, one with \"position\" has");
    motor.speed = speed->number(kFinite, "rad/s, or m/s");
  } else {
    motor.position = position->number(kFinite, "rad, or m");
    motor.stiffness = node.at("stiffness", "must be that of the motor's spring [N m/rad, or N/m]")
                          .number(kPositive, "N m/rad, or N/m");
    node.read("damping", motor.damping, kNonNegative, "N m s/rad, or N s/m");
  }
  node.read("max_force", motor.max_force, kPositive, "N m, or N");
  return motor;
}

void read_joint(const Node& node, Draft& draft) {
  node.check_keys(scene_keys("joint"));
  Joint joint;
  std::vector<std::pair<std::string, JointKind>> kinds;
  std::string names;
  for (const JointCard& card : kJointCards) {
    kinds.emplace_back(card.name, card.kind);
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", card.name);
  }
  joint.kind = node.at("type", "must be one of " + names).choice<JointKind>(kinds);
  const JointCard& card = joint_card(joint.kind);
  const char* const two = "must be two bodies: names or numbers in `bodies`, or \"world\"";
  const Node bodies = node.at("bodies", two);
  const std::vector<Node> ends = bodies.elements();
  if (ends.size() != 2) bodies.refuse(two);
  for (std::size_t k = 0; k < 2; ++k) joint.bodies[k] = read_held_body(ends[k], draft);
  read_anchors(node, card, joint);
  read_axes(node, card, joint);
  read_drive(node, card, joint);
  if (const auto fault = joint_fault(draft.scene, joint))
    Node(node.json(), node.path() + "." + fault->field, node.source())
        .fail(fault->value + " is not allowed: " + fault->expected);
  draft.scene.joints.push_back(joint);
}

void read_attachment(const Node& node, Draft& draft) {
  node.check_keys(scene_keys("attachment"));
  Attachment attachment;
  const char* const one = "must be the name or number of an elastic body";
  attachment.body = read_held_body(node.at("body", one), draft);
  attachment.to =
      read_held_body(node.at("to", "must be the name or number of a body, or \"world\""), draft);
  const char* const corners = "must be two corners at the start, [[x, y, z], [x, y, z]] [m]";
  const Node box = node.at("box", corners);
  const std::vector<Node> ends = box.elements();
  if (ends.size() != 2) box.refuse(corners);
  attachment.low = ends[0].vector("m");
  attachment.high = ends[1].vector("m");
  if (const auto fault = attachment_fault(draft.scene, attachment)) {
    if (fault->field != "box")
      node.at(fault->field, one).refuse(fault->expected);  // as named there
    Node(node.json(), node.path() + "." + fault->field, node.source())
        .fail(fault->value + " is not allowed: " + fault->expected);
  }
  draft.scene.attachments.push_back(attachment);
}

}  // namespace scree::reader
