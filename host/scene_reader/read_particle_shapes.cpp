#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/scene/scene_summary.h"
#include "host/scene_reader/particle_shapes.h"
#include "shapes/shape_card.h"

namespace scree::reader {
namespace {

void check_weights(const Node& node, const std::vector<double>& weights) {
  double sum = 0;
  for (const double weight : weights) sum += weight;
  if (!(sum > 0 && sum < kInfinity)) node.refuse("must have a positive sum, and a finite one");
}

/// @param what  that is drawn, in its unit
RadiusLaw read_law(const Node& node, const char* what, const char* unit) {
  const std::string must_be_positive = fmt::format("must be positive [{}]", unit);
  const auto size = [&](const Node& ends, const char* key) {
    return ends.at(key, must_be_positive).number(kPositive, unit);
  };
  RadiusLaw law;
  if (node.json().is_number()) {
    law.low = law.high = node.number(kPositive, unit);
    return law;
  }
  if (!node.json().is_object())
    node.refuse(fmt::format(
        "must be a positive number [{}] or one of {{min, max}}, {{values, weights}}, {{normal}}",
        unit));
  node.check_keys(scene_keys("radius"));
  if (node.has("values") + node.has("normal") + (node.has("min") || node.has("max")) != 1)
    node.refuse(fmt::format(
        "must have exactly one of {{min, max}}, {{values, weights}}, {{normal}} [{}]", unit));
  if (const auto values = node.find("values")) {
    law.kind = RadiusLaw::Kind::discrete;
    for (const Node& value : values->elements())
      law.values.push_back(value.number(kPositive, unit));
    if (law.values.empty())
      values->refuse(fmt::format("must hold one {} or more [{}]", what, unit));
    law.weights.assign(law.values.size(), 1.0);
    if (const auto weights = node.find("weights")) {
      const std::vector<Node> entries = weights->elements();
      if (entries.size() != law.values.size()) weights->refuse("must be one weight per value");
      for (std::size_t i = 0; i < entries.size(); ++i)
        law.weights[i] = entries[i].number(kNonNegative, "");
      check_weights(*weights, law.weights);
    }
    return law;
  }
  if (const auto weights = node.find("weights")) weights->fail("weights belong to values");
  const auto normal = node.find("normal");
  const Node& ends = normal ? *normal : node;
  if (normal) {
    normal->check_keys(scene_keys("radius_normal"));
    law.kind = RadiusLaw::Kind::normal;
    law.mean = size(*normal, "mean");
    law.deviation = normal->at("deviation", fmt::format("must be zero or positive [{}]", unit))
                        .number(kNonNegative, unit);
  } else {
    law.kind = RadiusLaw::Kind::uniform;
  }
  law.low = size(ends, "min");
  const Node max = ends.at("max", must_be_positive);
  law.high = max.number(kPositive, unit);
  if (law.high < law.low) max.refuse(fmt::format("must not be below min [{}]", unit));
  // A range that holds the mean is likely enough for draws to hit it, or narrow.
  if (normal && !(law.low <= law.mean && law.mean <= law.high))
    normal->at("mean", "").refuse(fmt::format("must be from min to max [{}]", unit));
  return law;
}

/// The keys that say something of a shape, without those that mean something else in `particles`.
std::vector<std::string> keys_of_shapes_alone() {
  const std::vector<std::string>& own = own_particle_keys();
  std::vector<std::string> keys;
  for (const std::string& key : shape_keys())
    if (std::find(own.begin(), own.end(), key) == own.end()) keys.push_back(key);
  return keys;
}

void add_shape(const Node& node, Draft& draft, ParticleShapes& read) {
  Shape shape;
  Vec3d position;
  read_shape(node, Named::free_body, shape, position, draft);
  read.size.radii.push_back(bounding_radius(draft.scene, shape));
  read.shapes.push_back(shape);
  const auto group = node.find("group");
  read.groups.push_back(group ? group_index(group->text(), draft) : -1);
}

/// Reads the shape of all particles. What the entry says beside it, it says of the particles.
/// @param is_from_file  then `file` is that of the particles
void add_only_shape(const Node& node, bool is_from_file, Draft& draft, ParticleShapes& read) {
  const Node kind = node.at("shape", "");
  const bool needs_file = kind.json() == "mesh" || (kind.json() == "hull" && !node.has("points"));
  if (is_from_file && needs_file)
    kind.fail(
        "the file is that of the particles; give a shape with a file of its own in the list "
        "shapes");
  Json shape = node.json();
  for (const std::string& key : own_particle_keys())
    if (key != "shape" && key != "radius" && (key != "file" || is_from_file)) shape.erase(key);
  add_shape(Node(shape, node.path(), node.source()), draft, read);
  read.size.weights = {1.0};
}

void add_shapes(const Node& list, Draft& draft, ParticleShapes& read) {
  for (const Node& entry : list.elements()) {
    entry.check_keys(scene_keys("particle_shape"));
    double weight = 1;
    entry.read("weight", weight, kNonNegative, "-");
    read.size.weights.push_back(weight);
    add_shape(entry, draft, read);
  }
  if (read.shapes.empty()) list.refuse("must hold one shape or more");
  check_weights(list, read.size.weights);
}

Shape scaled(const Shape& shape, double factor) {
  return factor == 1 ? shape : shape_card(shape.kind).scaled(shape, factor);
}

void set_groups(const ParticleShapes& from, const PerParticle<int>& shape, ParticleSet& set) {
  if (std::all_of(from.groups.begin(), from.groups.end(), [](int group) { return group < 0; }))
    return;
  const auto group_of = [&](std::size_t i) {
    const int own = from.groups[static_cast<std::size_t>(shape[i])];
    return own < 0 ? set.group[i] : own;
  };
  if (shape.uniform()) {
    set.group = group_of(0);
    return;
  }
  std::vector<int> groups(set.position.size());
  for (std::size_t i = 0; i < groups.size(); ++i) groups[i] = group_of(i);
  set.group = PerParticle<int>(std::move(groups));
}

/// @param low,high  ends of the scales that are drawn
void check_scale(const Node& node, const ParticleShapes& read, double low, double high) {
  for (const Shape& shape : read.shapes) {
    const ShapeCard& card = shape_card(shape.kind);
    if (card.scaled == nullptr) node.fail(fmt::format("a {} cannot be scaled", card.name));
    for (const double factor : {low, high})
      if (const auto fault = card.fault(scaled(shape, factor)))
        node.fail(fmt::format("a scale of {} makes the {} of a {} {}, {}", factor, fault->field,
                              card.name, fault->value, fault->expected));
  }
}

/// The shapes of an entry that has `shape` or `shapes`.
ParticleShapes read_given_shapes(const Node& node, bool is_from_file, Draft& draft) {
  const auto several = node.find("shapes"), scale = node.find("scale");
  RadiusLaw law;
  law.low = law.high = 1;
  ParticleShapes read{{}, {}, scale ? read_law(*scale, "scale", "-") : law};
  if (!several) {
    add_only_shape(node, is_from_file, draft, read);
  } else {
    if (node.has("shape")) several->fail("give either shape or shapes");
    const std::string why = "give it in the entries of shapes; here, a scale is for all of them";
    node.refuse_keys(keys_of_shapes_alone(), why);
    node.refuse_keys({"radius"}, why);
    if (!is_from_file) node.refuse_keys({"file"}, why);
    add_shapes(*several, draft, read);
  }
  if (scale) check_scale(*scale, read, read.size.scale.smallest(), read.size.scale.largest());
  return read;
}

/// Refuses the keys that say something of shapes and of scales.
void refuse_without_shape(const Node& node) {
  const std::string why = "this key goes with a shape, and none is given; spheres have a radius";
  node.refuse_keys(keys_of_shapes_alone(), why);
  node.refuse_keys({"scale"}, why);
}

bool has_shape(const Node& node) { return node.has("shape") || node.has("shapes"); }

}  // namespace

ParticleShapes read_particle_shapes(const Node& node, Draft& draft) {
  if (has_shape(node)) return read_given_shapes(node, false, draft);
  refuse_without_shape(node);
  return {{}, {}, read_law(node.at("radius", "must be positive [m]"), "radius", "m")};
}

ParticleShapes read_shapes_of_file(const Node& node, Draft& draft) {
  if (has_shape(node)) return read_given_shapes(node, true, draft);
  refuse_without_shape(node);
  return {{}, {}, RadiusLaw{}};
}

void check_scales(const Node& named, const ParticleShapes& shapes, const PerParticle<double>& scale,
                  std::size_t count) {
  if (scale.uniform()) return;
  double low = scale[0], high = scale[0];
  for (std::size_t i = 1; i < count; ++i) {
    low = std::min(low, scale[i]);
    high = std::max(high, scale[i]);
  }
  check_scale(named, shapes, low, high);
}

void set_placed(const ParticleShapes& from, PlacedSpheres placed, const Scene& scene,
                ParticleSet& set) {
  set.position = std::move(placed.center);
  set.radius = std::move(placed.radius);
  set_groups(from, placed.shape, set);
  if (std::all_of(from.shapes.begin(), from.shapes.end(),
                  [](const Shape& shape) { return shape_card(shape.kind).is_ball; }))
    return;
  const auto shape_of = [&](std::size_t i) {
    return scaled(from.shapes[static_cast<std::size_t>(placed.shape[i])], placed.scale[i]);
  };
  if (placed.shape.uniform() && placed.scale.uniform()) {
    set.shape = shape_of(0);
    set.radius = bounding_radius(scene, set.shape[0]);
    return;
  }
  std::vector<Shape> shapes(set.position.size());
  std::vector<double> radii(shapes.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    shapes[i] = shape_of(i);
    // The radius that was drawn may differ from it in the last bit.
    radii[i] = bounding_radius(scene, shapes[i]);
  }
  set.shape = PerParticle<Shape>(std::move(shapes));
  set.radius = PerParticle<double>(std::move(radii));
}

}  // namespace scree::reader
