// Entries of `joints`: which bodies, where, and what they leave free.

#include <fmt/format.h>

#include "host/scene/scene_checks.h"
#include "host/scene_reader/parts.h"

namespace scree::reader {
namespace {

/// Entry of `bodies` that a name or a number stands for.
std::size_t entry_of(const Node& node, const Draft& draft) {
  const std::size_t count = draft.body_of_entry.size();
  if (!node.json().is_string()) {
    if (count == 0) node.refuse("must be \"world\": the scene has no `bodies`");
    return static_cast<std::size_t>(node.integer(0, static_cast<long long>(count) - 1));
  }
  const std::string name = node.text();
  const auto found = draft.entry_of_name.find(name);
  if (found != draft.entry_of_name.end()) return found->second;
  std::vector<std::string> known{kWorldName};
  for (const auto& [other, entry] : draft.entry_of_name) known.push_back(other);
  node.refuse(
      "must be the `name` of one of `bodies`, its number in that list from 0, or \"world\"" +
      nearest_hint(name, known));
}

/// Index in Scene::bodies, or kWorldBody.
int read_body_of_joint(const Node& node, const Draft& draft) {
  if (node.json().is_string() && node.text() == kWorldName) return kWorldBody;
  const int body = draft.body_of_entry[entry_of(node, draft)];
  if (body == kInserted) node.refuse("must be there from the start, without insert_at");
  return body;
}

}  // namespace

void read_joint(const Node& node, Draft& draft) {
  node.check_keys(scene_keys("joint"));
  Joint joint;
  const Node type = node.at("type", "must be one of \"hinge\", \"ball\", \"fixed\"");
  joint.kind = type.choice<JointKind>(
      {{"hinge", JointKind::hinge}, {"ball", JointKind::ball}, {"fixed", JointKind::fixed}});
  const char* const two = "must be two bodies: names or numbers in `bodies`, or \"world\"";
  const Node bodies = node.at("bodies", two);
  const std::vector<Node> ends = bodies.elements();
  if (ends.size() != 2) bodies.refuse(two);
  for (std::size_t k = 0; k < 2; ++k) joint.bodies[k] = read_body_of_joint(ends[k], draft);
  joint.anchor =
      node.at("anchor", "must be a point of both bodies at the start, [x, y, z] [m]").vector("m");
  if (joint.kind == JointKind::hinge) {
    joint.axis =
        node.at("axis", "a hinge needs the direction it turns about, [x, y, z]").direction();
  } else if (const auto axis = node.find("axis")) {
    axis->fail("a joint of type \"" + type.text() + "\" has no such key");
  }
  if (const auto fault = joint_fault(draft.scene, joint))
    Node(node.json(), node.path() + "." + fault->field, node.source())
        .fail(fault->value + " is not allowed: " + fault->expected);
  draft.scene.joints.push_back(joint);
}

}  // namespace scree::reader
