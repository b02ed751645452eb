// Compounds: a list of parts, and how what they have in common counts.

#include <fmt/format.h>

#include <stdexcept>

#include "host/scene/compound.h"
#include "host/scene_reader/parts.h"
#include "shapes/shape_card.h"

namespace scree::reader {
namespace {

ShapePart read_part(const Node& node, Draft& draft) {
  node.check_keys(scene_keys("shape_part"));
  ShapePart part;
  Vec3d unused;
  read_shape(node, Named::part, part.shape, unused, draft);
  const LocalFrame frame = draft.shape_frame;
  node.read("position", part.position, "m");
  read_orientation(node, part.orientation);
  part.position += rotate(part.orientation, frame.origin);
  part.orientation = part.orientation * frame.axes;
  return part;
}

CompoundBody make(const Node& node, bool is_free, Draft& draft) {
  const Node list = node.at("parts", "must be a list of shapes");
  std::vector<ShapePart> parts;
  for (const Node& entry : list.elements()) parts.push_back(read_part(entry, draft));
  if (parts.empty()) list.refuse("must hold one shape or more");
  SharedMass shared = SharedMass::once;
  if (const auto overlaps = node.find("overlaps"))
    shared =
        overlaps->choice<SharedMass>({{"once", SharedMass::once}, {"each", SharedMass::each_part}});
  try {
    return make_compound(draft.scene, std::move(parts), shared, is_free);
  } catch (const std::invalid_argument& error) {
    list.fail(error.what());
  }
}

}  // namespace

void read_compound(const Node& node, bool is_free, Shape& shape, Draft& draft) {
  const auto overlaps = node.find("overlaps");
  const std::string key =
      fmt::format("compound|{}|{}|{}", is_free, overlaps ? overlaps->json().dump() : "",
                  node.at("parts", "must be a list of shapes").json().dump());
  const auto known = draft.shapes.find(key);
  if (known == draft.shapes.end()) {
    CompoundBody made = make(node, is_free, draft);
    made.shape.mesh = static_cast<int>(draft.scene.meshes.size());
    draft.scene.meshes.push_back(std::move(made.mesh));
    draft.shapes[key] = {made.shape, made.frame};
  }
  shape = draft.shapes.at(key).shape;
  draft.shape_frame = draft.shapes.at(key).frame;
}

}  // namespace scree::reader
