// Entries of `bodies`: shape, pose, mass and motion.

#include <fmt/format.h>

#include <algorithm>

#include "host/scene/convex_hull.h"
#include "host/scene/free_mesh.h"
#include "host/scene/mesh_reader.h"
#include "host/scene/particle_table.h"
#include "host/scene/scene_checks.h"
#include "host/scene_reader/parts.h"
#include "shapes/mesh.h"
#include "shapes/rounded.h"
#include "shapes/shape_card.h"

namespace scree::reader {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

/// Points of a hull, and what tells them apart from those of others.
std::vector<Vec3d> read_points(const Node& node, std::string& key) {
  std::vector<Vec3d> points;
  if (const auto list = node.find("points")) {
    node.refuse_keys({"file", "scale"}, "give either points or a file");
    for (const Node& point : list->elements()) points.push_back(point.vector("m"));
    key = list->json().dump();
    return points;
  }
  MeshOptions options;
  options.closed = false;  // only its vertices count
  const Node file = node.at("file", "must be the name of an .stl or .obj file, or give points [m]");
  const std::filesystem::path path = file.file();
  node.read("scale", options.scale, kPositive, "m per unit of the file");
  key = fmt::format("{}|{}", path.string(), options.scale);
  return file.from_file([&](const auto& p) { return read_mesh(p, options); }).vertices;
}

/// @param is_free  the mesh is moved to the center of mass and the principal axes of the solid inside
void read_mesh_file(const Node& node, bool is_free, Shape& shape, Draft& draft) {
  const Node file = node.at("file", "must be the name of an .stl, .obj, .msh or .vtk file");
  const std::filesystem::path path = file.file();
  MeshOptions options;
  node.read("scale", options.scale, kPositive, "m per unit of the file");
  node.read("closed", options.closed);
  if (is_free && !options.closed)
    node.at("closed", "").refuse("must be true: only closed surfaces can be free");
  const std::string key =
      fmt::format("mesh|{}|{}|{}|{}", is_free, path.string(), options.scale, options.closed);
  const auto [shared, is_new] = draft.shapes.emplace(key, SharedShape{});
  if (is_new) {
    TriangleMesh mesh = file.from_file([&](const auto& p) { return read_mesh(p, options); });
    Shape& made = shared->second.shape;
    made.kind = shapes::Mesh::kind;
    if (is_free) {
      const auto frame = move_inside_to_principal_frame(mesh);
      if (!frame) file.refuse("must enclose a volume, since the body is free");
      shared->second.frame = *frame;
      shapes::Mesh::measure(mesh, made);
    }
    made.mesh = static_cast<int>(draft.scene.meshes.size());
    draft.scene.meshes.push_back(std::move(mesh));
  }
  shape = shared->second.shape;
  draft.shape_frame = shared->second.frame;
  if (is_free && node.has("elastic")) {  // what bends has a mesh of its own
    draft.scene.meshes.push_back(draft.scene.meshes[static_cast<std::size_t>(shape.mesh)]);
    shape.mesh = static_cast<int>(draft.scene.meshes.size()) - 1;
  }
}

/// An entry of `bodies`.
class NodeSource final : public ShapeSource {
 public:
  /// @param is_free  the body is
  NodeSource(const Node& node, bool is_free, Draft& draft)
      : node_(node), is_free_(is_free), draft_(draft) {}

  bool has(const char* key) const override { return node_.has(key); }
  double length(const char* key) const override {
    return node_.at(key, "must be positive [m]").number(kPositive, "m");
  }
  Vec3d edges(const char* key) const override {
    const Node size = node_.at(key, "must be three full edge lengths [x, y, z] [m]");
    const Vec3d edges = size.vector("m");
    if (!(edges.x > 0 && edges.y > 0 && edges.z > 0)) size.refuse("must be positive [m]");
    return edges;
  }
  Vec3d direction(const char* key) const override {
    return node_.at(key, "must be a direction [x, y, z]").direction();
  }
  Vec3d point(const char* key, const char* expected) const override {
    return node_.at(key, expected).vector("m");
  }
  unsigned faces(const char* key) const override {
    const std::vector<std::pair<std::string, unsigned>> names{{"-x", 1}, {"+x", 2},  {"-y", 4},
                                                              {"+y", 8}, {"-z", 16}, {"+z", 32}};
    unsigned bits = 0;
    for (const Node& face : node_.at(key, "must be a list of faces").elements())
      bits |= face.choice(names);
    return bits;
  }
  void read_mesh(Shape& shape) const override {
    // Unlike those of other shapes, its bodies are free where the file says so.
    const bool is_free = is_free_ && node_.has("kind") && meshes_may_be_free(draft_.scene);
    read_mesh_file(node_, is_free, shape, draft_);
  }
  int height_field() const override { return read_height_field(node_, draft_); }
  void read_hull(Shape& shape) const override {
    std::string key;
    const std::vector<Vec3d> points = read_points(node_, key);
    const double rounding = node_.has(kRoundingKey.key) ? length(kRoundingKey.key) : 0;
    const auto [hull, is_new] =
        draft_.shapes.emplace(fmt::format("hull|{}|{}|{}", is_free_, rounding, key), SharedShape{});
    if (is_new) {
      TriangleMesh mesh;
      try {
        mesh = convex_hull(points, "hull");
      } catch (const std::invalid_argument& error) {
        if (node_.has("points")) node_.at("points", "").fail(error.what());
        node_.at("file", "").refuse(error.what());
      }
      if (is_free_) hull->second.frame = move_to_principal_frame(mesh, rounding);
      hull->second.shape = hull_of(mesh, rounding);
      hull->second.shape.mesh = static_cast<int>(draft_.scene.meshes.size());
      draft_.scene.meshes.push_back(std::move(mesh));
    }
    shape = hull->second.shape;
    draft_.shape_frame = hull->second.frame;
  }
  void read_compound(Shape& shape) const override {
    reader::read_compound(node_, is_free_, shape, draft_);
  }
  void exclude(std::span<const char* const> keys, const char* why) const override {
    node_.refuse_keys({keys.begin(), keys.end()}, why);
  }
  [[noreturn]] void refuse(const char* key, const char* expected) const override {
    node_.at(key, expected).refuse(expected);
  }

 private:
  const Node& node_;
  bool is_free_;
  Draft& draft_;
};

void refuse_keys_of_other_shapes(const Node& node, const ShapeCard& own) {
  for (const std::string& key : shape_keys()) {
    const bool is_own = std::any_of(own.keys.begin(), own.keys.end(),
                                    [&](const ShapeKey& k) { return key == k.key; });
    if (!is_own) node.refuse_keys({key}, fmt::format("a {} has no such key", own.name));
  }
}

/// Rounds a shape where the entry says so; hulls are rounded already.
void round_shape(const Node& node, const ShapeSource& source, Shape& shape) {
  const auto rounding = node.find(kRoundingKey.key);
  if (!rounding) return;
  if (!has_hull(shape)) shape = shapes::Rounded::of(shape, source.length(kRoundingKey.key));
  if (const auto fault = shape_card(shape.kind).fault(shape))
    rounding->fail(fmt::format("{} is not allowed: {}", fault->value, fault->expected));
}

/// Sizes that fit no shape, by the keys that were written.
void check_sizes(const Node& node, const Shape& shape, const ShapeCard& card) {
  const auto fault = card.fault(shape);
  if (!fault || fault->field != "half_extents") return;
  std::string given;
  for (const ShapeKey& key : card.keys)
    if (const auto value = node.find(key.key))
      given += fmt::format("{}{} {}", given.empty() ? "" : ", ", key.key, value->json().dump());
  node.fail(fmt::format("{} is not allowed: half of the edges of the box about it, {}, {}", given,
                        fault->value, fault->expected));
}

void read_kind(const Node& node, const Draft& draft, BodyDescription& body) {
  const bool may_be_free = shape_card(body.shape.kind).may_be_free();
  body.kind = may_be_free ? BodyKind::free : BodyKind::fixed;
  if (const auto kind = node.find("kind")) {
    body.kind = kind->choice<BodyKind>(
        {{"free", BodyKind::free}, {"fixed", BodyKind::fixed}, {"kinematic", BodyKind::kinematic}});
    const bool meshes = meshes_may_be_free(draft.scene);
    if (body.kind == BodyKind::free && !shape_card(body.shape.kind).may_be_free_where(meshes))
      kind->refuse(
          fmt::format("only {} bodies can be free", shape_names(&ShapeCard::may_be_free, " or ")));
  }
  if (body.kind != BodyKind::free)
    node.refuse_keys(
        {"velocity", "angular_velocity", "mass", "density", "inertia", "lock", "insert_at", "force",
         "torque", "elastic"},
        "only free bodies have this key (a moving wall is \"kinematic\" and has a motion)");
}

void read_pose(const Node& node, BodyDescription& body) {
  node.read("position", body.position, "m");
  read_orientation(node, body.orientation);
}

/// Keeps the name for joints and programs.
void read_name(const Node& node, std::size_t index, Draft& draft) {
  const auto key = node.find("name");
  if (!key) return;
  const std::string name = key->text();
  if (name.empty() || name == kWorldName)
    key->refuse("must be a name, and not \"world\", which stands for what bodies are fixed to");
  const auto [first, is_new] = draft.entry_of_name.emplace(name, index);
  if (!is_new) key->refuse(fmt::format("bodies[{}] has this name", first->second));
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

Elasticity read_elasticity(const Node& node) {
  node.check_keys(scene_keys("elasticity"));
  Elasticity e;
  e.young_modulus = node.at("young_modulus", "must be positive [Pa]").number(kPositive, "Pa");
  node.read("poisson_ratio", e.poisson_ratio, kFinite, "");
  return e;
}

}  // namespace

void read_shape(const Node& node, Named named, Shape& shape, Vec3d& position, Draft& draft) {
  std::vector<std::pair<std::string, ShapeKind>> names;
  std::string list;
  for (const ShapeCard& card : shape_cards()) {
    if (!card.is_named || (named == Named::free_body && !card.may_be_free())) continue;
    if (named == Named::part && !card.may_be_part()) continue;
    names.emplace_back(card.name, card.kind);
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", card.name);
  }
  shape.kind = node.at("shape", "must be one of " + list).choice(names);
  const ShapeCard& card = shape_card(shape.kind);
  refuse_keys_of_other_shapes(node, card);
  const auto kind = node.find("kind");
  const bool is_free = named != Named::body || !kind || kind->json() == "free";
  draft.shape_frame = {};
  const NodeSource source(node, is_free, draft);
  card.read(source, shape, position);
  check_sizes(node, shape, card);
  round_shape(node, source, shape);
}

void read_orientation(const Node& node, Quatd& orientation) {
  if (const auto key = node.find("orientation")) {
    node.refuse_keys({"rotation_deg"}, "give either orientation or rotation_deg");
    orientation = key->orientation();
  }
  if (const auto rotation = node.find("rotation_deg")) {
    rotation->check_keys(scene_keys("rotation"));
    const Vec3d axis = rotation->at("axis", "must be a direction [x, y, z]").direction();
    const double angle = rotation->at("angle", "must be a number [deg]").number(kFinite, "deg");
    orientation = exp_map(angle * kDegree * axis);
  }
}

void read_body(const Node& node, std::size_t index, Draft& draft) {
  node.check_keys(scene_keys("body"));
  BodyDescription body;
  body.entry = static_cast<int>(index);
  read_name(node, index, draft);
  read_shape(node, Named::body, body.shape, body.position, draft);
  read_kind(node, draft, body);
  const LocalFrame frame = draft.shape_frame;
  read_pose(node, body);
  body.position += rotate(body.orientation, frame.origin);
  body.orientation = body.orientation * frame.axes;
  if (body.kind == BodyKind::free) {
    node.read("velocity", body.velocity, "m/s");
    node.read("angular_velocity", body.angular_velocity, "rad/s");
    read_mass(node, body);
    if (const auto lock = node.find("lock")) body.locks = read_locks(*lock);
    Load load;
    node.read("force", load.force, "N");
    node.read("torque", load.torque, "N m");
    if (norm2(load.force) > 0 || norm2(load.torque) > 0) body.load = load;
    if (const auto elastic = node.find("elastic")) {
      node.refuse_keys({"inertia"}, "an elastic body has the moments of its tetrahedra");
      body.elastic = read_elasticity(*elastic);
    }
  }
  node.read("collision_group", body.collision_group, 0, kRestingGroup - 1);
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
  const auto time = node.find("insert_at");
  draft.body_of_entry.push_back(time ? kInserted : static_cast<int>(draft.scene.bodies.size()));
  if (time)
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
      {"angular_velocity", {MotionKind::linear}},
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
      node.refuse_keys({key}, "a motion of type \"" + type.text() + "\" has no such key");

  node.read("start", motion.start, kFinite, "s");
  if (const auto stop = node.find("stop")) {
    motion.stop = stop->number(kFinite, "s");
    if (motion.stop < motion.start) stop->refuse("must not be before start [s]");
  }
  switch (motion.kind) {
    case MotionKind::linear:
      motion.velocity = node.at("velocity", "must be three numbers [x, y, z] [m/s]").vector("m/s");
      node.read("angular_velocity", motion.angular_velocity, "rad/s");
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
        node.refuse_keys({"times", "positions", "orientations"},
                         "give either a file or times and positions");
        file->from_file([&](const auto& path) { read_motion_csv(path, motion); });
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
