// Entries of `bodies`: shape, pose, mass and motion.

#include <fmt/format.h>

#include <algorithm>

#include "host/scene/mesh_reader.h"
#include "host/scene/particle_table.h"
#include "host/scene/scene_checks.h"
#include "host/scene_reader/parts.h"

namespace scree::reader {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

using Kind = Shape::Kind;

const std::vector<std::pair<std::string, Kind>> kShapes{{"sphere", Kind::sphere},
                                                        {"box", Kind::box},
                                                        {"half_space", Kind::half_space},
                                                        {"container", Kind::container},
                                                        {"mesh", Kind::mesh}};

/// Refuses keys that exist but mean nothing here, such as a radius of a box.
void refuse_keys(const Node& node, const std::vector<std::string>& keys, const std::string& why) {
  for (const std::string& key : keys)
    if (const auto found = node.find(key)) found->fail(why);
}

void refuse_keys_of_other_shapes(const Node& node, Kind kind, const std::string& name) {
  const std::vector<std::pair<std::string, std::vector<Kind>>> shape_keys{
      {"radius", {Kind::sphere}},     {"size", {Kind::box, Kind::container}},
      {"normal", {Kind::half_space}}, {"point", {Kind::half_space}},
      {"min", {Kind::container}},     {"max", {Kind::container}},
      {"open", {Kind::container}},    {"file", {Kind::mesh}},
      {"scale", {Kind::mesh}},        {"closed", {Kind::mesh}}};
  for (const auto& [key, kinds] : shape_keys)
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      refuse_keys(node, {key}, "a " + name + " has no such key");
}

Vec3d read_half_extents(const Node& node) {
  const Node size = node.at("size", "must be three full edge lengths [x, y, z] [m]");
  const Vec3d edges = size.vector("m");
  if (!(edges.x > 0 && edges.y > 0 && edges.z > 0)) size.refuse("must be positive [m]");
  return 0.5 * edges;
}

unsigned read_open_faces(const Node& node) {
  const std::vector<std::pair<std::string, unsigned>> names{{"-x", 1}, {"+x", 2},  {"-y", 4},
                                                            {"+y", 8}, {"-z", 16}, {"+z", 32}};
  unsigned bits = 0;
  for (const Node& face : node.elements()) bits |= face.choice(names);
  return bits;
}

void read_container(const Node& node, BodyDescription& body) {
  const bool by_corners = node.has("min") || node.has("max");
  if (by_corners) {
    refuse_keys(node, {"size", "position"}, "give either min and max, or size and position");
    const Vec3d low = node.at("min", "must be the lower corner [x, y, z] [m]").vector("m");
    const Node max = node.at("max", "must be the upper corner [x, y, z] [m]");
    const Vec3d high = max.vector("m");
    if (!(low.x < high.x && low.y < high.y && low.z < high.z))
      max.refuse("must be above min on every axis [m]");
    body.shape.half_extents = 0.5 * (high - low);
    body.position = 0.5 * (low + high);
  } else {
    body.shape.half_extents = read_half_extents(node);
  }
  if (const auto open = node.find("open")) body.shape.open_faces = read_open_faces(*open);
}

void read_mesh_shape(const Node& node, BodyDescription& body, Draft& draft) {
  const Node file = node.at("file", "must be the name of an .stl or .obj file");
  const std::filesystem::path path = file.file();
  MeshOptions options;
  node.read("scale", options.scale, kPositive, "m per unit of the file");
  node.read("closed", options.closed);
  const std::string key = fmt::format("{}|{}|{}", path.string(), options.scale, options.closed);
  const auto [entry, is_new] =
      draft.meshes.emplace(key, static_cast<int>(draft.scene.meshes.size()));
  if (is_new) draft.scene.meshes.push_back(read_mesh(path, options));
  body.shape.mesh = entry->second;
}

void read_shape(const Node& node, BodyDescription& body, Draft& draft) {
  const Node shape = node.at("shape",
                             "must be one of \"sphere\", \"box\", \"half_space\", "
                             "\"container\", \"mesh\"");
  body.shape.kind = shape.choice(kShapes);
  refuse_keys_of_other_shapes(node, body.shape.kind, shape.text());
  switch (body.shape.kind) {
    case Kind::sphere:
      body.shape.radius = node.at("radius", "must be positive [m]").number(kPositive, "m");
      break;
    case Kind::box:
      body.shape.half_extents = read_half_extents(node);
      break;
    case Kind::half_space:
      if (const auto normal = node.find("normal")) body.shape.normal = normal->direction();
      if (const auto point = node.find("point")) {
        refuse_keys(node, {"position"}, "give either point or position");
        body.position = point->vector("m");
      }
      break;
    case Kind::container:
      read_container(node, body);
      break;
    case Kind::mesh:
      read_mesh_shape(node, body, draft);
      break;
  }
}

void read_kind(const Node& node, BodyDescription& body) {
  const bool solid = body.shape.kind == Kind::sphere || body.shape.kind == Kind::box;
  body.kind = solid ? BodyKind::free : BodyKind::fixed;
  if (const auto kind = node.find("kind")) {
    body.kind = kind->choice<BodyKind>(
        {{"free", BodyKind::free}, {"fixed", BodyKind::fixed}, {"kinematic", BodyKind::kinematic}});
    if (body.kind == BodyKind::free && !solid) kind->refuse("only spheres and boxes can be free");
  }
  if (body.kind != BodyKind::free)
    refuse_keys(node,
                {"velocity", "angular_velocity", "mass", "density", "inertia", "lock", "insert_at"},
                "only free bodies have this key (a moving wall is \"kinematic\" and has a motion)");
}

void read_pose(const Node& node, BodyDescription& body) {
  node.read("position", body.position, "m");
  if (const auto orientation = node.find("orientation")) {
    refuse_keys(node, {"rotation_deg"}, "give either orientation or rotation_deg");
    body.orientation = orientation->orientation();
  }
  if (const auto rotation = node.find("rotation_deg")) {
    rotation->check_keys(scene_keys("rotation"));
    const Vec3d axis = rotation->at("axis", "must be a direction [x, y, z]").direction();
    const double angle = rotation->at("angle", "must be a number [deg]").number(kFinite, "deg");
    body.orientation = exp_map(angle * kDegree * axis);
  }
}

void read_mass(const Node& node, BodyDescription& body) {
  const auto mass = node.find("mass");
  const auto density = node.find("density");
  if (mass && density) density->fail("give either mass or density");
  if (mass) {
    // Moments of a solid body of that mass: they are proportional to the density.
    set_mass_from_density(body, 1.0);
    const double value = mass->number(kPositive, "kg");
    body.inertia *= value / body.mass;
    body.mass = value;
  } else {
    const Node given = node.at("density", "a free body needs a density [kg/m^3] or a mass [kg]");
    set_mass_from_density(body, given.number(kPositive, "kg/m^3"));
  }
  if (const auto inertia = node.find("inertia")) {
    body.inertia = inertia->vector("kg m^2");
    if (!(body.inertia.x > 0 && body.inertia.y > 0 && body.inertia.z > 0))
      inertia->refuse("must be three positive principal moments [kg m^2]");
  }
}

}  // namespace

void read_body(const Node& node, std::size_t index, Draft& draft) {
  node.check_keys(scene_keys("body"));
  BodyDescription body;
  body.entry = static_cast<int>(index);
  read_shape(node, body, draft);
  read_kind(node, body);
  read_pose(node, body);
  if (body.kind == BodyKind::free) {
    node.read("velocity", body.velocity, "m/s");
    node.read("angular_velocity", body.angular_velocity, "rad/s");
    read_mass(node, body);
    if (const auto lock = node.find("lock")) body.locks = read_locks(*lock);
  }
  body.material = read_material(node, draft);
  const auto group = node.find("group");
  body.group = group_index(
      group ? group->text() : (body.kind == BodyKind::free ? "bodies" : "walls"), draft);
  if (const auto motion = node.find("motion")) {
    if (body.kind != BodyKind::kinematic)
      motion->fail("only bodies of kind \"kinematic\" have a motion");
    Motion read;
    read_motion(*motion, read);
    body.motion = std::move(read);
  } else if (body.kind == BodyKind::kinematic) {
    node.fail_missing("motion", "a kinematic body needs one");
  }
  if (const auto fault = body_fault(draft.scene, body))
    Node(node.json(), node.path() + "." + fault->field, node.source())
        .fail(fault->value + " is not allowed: " + fault->expected);
  if (const auto time = node.find("insert_at"))
    draft.inserted[time->number(kNonNegative, "s")].bodies.push_back(std::move(body));
  else
    draft.scene.bodies.push_back(std::move(body));
}

void read_motion(const Node& node, Motion& motion) {
  node.check_keys(scene_keys("motion"));
  const Node type = node.at("type",
                            "must be one of \"linear\", \"rotating\", \"oscillating\", "
                            "\"sampled\"");
  using MotionKind = Motion::Kind;
  motion.kind = type.choice<MotionKind>({{"linear", MotionKind::linear},
                                         {"rotating", MotionKind::rotating},
                                         {"oscillating", MotionKind::oscillating},
                                         {"sampled", MotionKind::sampled}});
  const std::vector<std::pair<std::string, std::vector<MotionKind>>> motion_keys{
      {"velocity", {MotionKind::linear}},
      {"axis", {MotionKind::rotating, MotionKind::oscillating}},
      {"center", {MotionKind::rotating}},
      {"rate", {MotionKind::rotating}},
      {"amplitude", {MotionKind::oscillating}},
      {"frequency", {MotionKind::oscillating}},
      {"phase", {MotionKind::oscillating}},
      {"times", {MotionKind::sampled}},
      {"positions", {MotionKind::sampled}},
      {"orientations", {MotionKind::sampled}},
      {"file", {MotionKind::sampled}}};
  for (const auto& [key, kinds] : motion_keys)
    if (std::find(kinds.begin(), kinds.end(), motion.kind) == kinds.end())
      refuse_keys(node, {key}, "a motion of type \"" + type.text() + "\" has no such key");

  node.read("start", motion.start, kFinite, "s");
  if (const auto stop = node.find("stop")) {
    motion.stop = stop->number(kFinite, "s");
    if (motion.stop < motion.start) stop->refuse("must not be before start [s]");
  }
  switch (motion.kind) {
    case MotionKind::linear:
      motion.velocity = node.at("velocity", "must be three numbers [x, y, z] [m/s]").vector("m/s");
      break;
    case MotionKind::rotating:
      motion.axis = node.at("axis", "must be a direction [x, y, z]").direction();
      node.read("center", motion.center, "m");
      motion.rate = node.at("rate", "must be a number [rad/s]").number(kFinite, "rad/s");
      break;
    case MotionKind::oscillating:
      motion.axis = node.at("axis", "must be a direction [x, y, z]").direction();
      motion.amplitude = node.at("amplitude", "must be a number [m]").number(kFinite, "m");
      motion.frequency =
          node.at("frequency", "must be zero or positive [Hz]").number(kNonNegative, "Hz");
      node.read("phase", motion.phase, kFinite, "rad");
      break;
    case MotionKind::sampled:
      if (const auto file = node.find("file")) {
        refuse_keys(node, {"times", "positions", "orientations"},
                    "give either a file or times and positions");
        read_motion_csv(file->file(), motion);
        break;
      }
      for (const Node& t :
           node.at("times", "must be a list of times [s], or give a file").elements())
        motion.times.push_back(t.number(kFinite, "s"));
      for (const Node& p : node.at("positions", "must be a list of [x, y, z] [m]").elements())
        motion.positions.push_back(p.vector("m"));
      if (const auto orientations = node.find("orientations"))
        for (const Node& q : orientations->elements())
          motion.orientations.push_back(q.orientation());
      break;
    case MotionKind::none:
      break;
  }
}

}  // namespace scree::reader
