// Entries of `urdf`: a model from a file, where it stands, and what drives it.

#include <fmt/format.h>

#include "host/scene/scene_checks.h"
#include "host/scene/urdf_checks.h"
#include "host/scene_reader/parts.h"
#include "host/urdf.h"

namespace scree::reader {
namespace {

UrdfPlacement read_placement(const Node& node, Draft& draft) {
  UrdfPlacement placement;
  if (const auto name = node.find("name")) placement.name = name->text();
  node.read("position", placement.pose.position, "m");
  read_orientation(node, placement.pose.orientation);
  node.read("velocity", placement.velocity, "m/s");
  node.read("angular_velocity", placement.angular_velocity, "rad/s");
  node.read("fixed_base", placement.fixed_base);
  placement.surface.material = read_material(node, draft);
  const auto group = node.find("group");
  placement.surface.group = group_index(group ? group->text() : "bodies", draft);
  if (const auto links = node.find("links"))
    for (const auto& [name, link] : links->members()) {
      link.check_keys(scene_keys("urdf_link"));
      UrdfSurface surface = placement.surface;
      if (link.has("material")) surface.material = read_material(link, draft);
      if (const auto own = link.find("group")) surface.group = group_index(own->text(), draft);
      placement.surfaces[name] = surface;
    }
  if (const auto positions = node.find("joint_positions"))
    for (const auto& [name, position] : positions->members())
      placement.joint_positions[name] = position.number(kFinite, "rad, or m");
  return placement;
}

/// What drives the joints of a model. A name that none has is refused later, with the others of the placement.
void read_motors(const Node& node, const UrdfModel& model, UrdfPlacement& placement) {
  const auto motors = node.find("motors");
  if (!motors) return;
  for (const auto& [name, motor] : motors->members()) {
    const char* key = urdf_motor_key(model, name);
    if (key == nullptr) key = motor.has("force") ? "force" : "torque";
    placement.motors[name] = read_joint_motor(motor, key);
  }
}

std::string note_of(const UrdfModel& model, const UrdfBodies& added) {
  std::string text =
      fmt::format("{}: {} bodies of {} links, {} joints, {:.4g} kg", model.file, added.body_count,
                  model.links.size(), added.joint_count, added.mass);
  std::string others;
  for (const auto& [name, count] : model.not_read)
    others += fmt::format("{}<{}> ({})", others.empty() ? "" : ", ", name, count);
  if (!others.empty()) text += "; not used: " + others;
  for (const std::string& note : added.notes) text += "; " + note;
  return text;
}

}  // namespace

void read_urdf_entry(const Node& node, Draft& draft) {
  node.check_keys(scene_keys("urdf"));
  UrdfPlacement placement = read_placement(node, draft);
  const Node file = node.at("file", "must be the name of a .urdf file");
  const UrdfModel model = file.from_file([](const auto& path) { return read_urdf(path); });
  read_motors(node, model, placement);
  if (const auto fault = placement_fault(model, placement))
    Node(node.json(), node.path() + "." + fault->field, node.source())
        .fail(fault->value + " is not allowed: " + fault->expected);
  draft.notes.push_back(file.from_file(
      [&](const auto&) { return note_of(model, add_urdf(draft.scene, model, placement)); }));
  for (const auto& [name, body] : draft.scene.body_names)
    if (const auto taken = draft.entry_of_name.find(name); taken != draft.entry_of_name.end())
      node.fail(
          fmt::format("bodies[{}] is called \"{}\", as a body of this model", taken->second, name));
}

}  // namespace scree::reader
