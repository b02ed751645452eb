// Bodies of scenes of rigid-ipc, and joints of those of Autodesk's program.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/error.h"
#include "host/scene/free_mesh.h"
#include "host/scene/mesh_reader.h"
#include "host/scene/surface_mass.h"
#include "host/scene_reader/ipc_import.h"
#include "kernels/bodies/range.h"
#include "shapes/mesh.h"

namespace scree::ipc {
namespace {

using reader::kFinite;
using reader::kNonNegative;
using reader::kPositive;

constexpr int kLeastTriangles = 4;  // of a solid
constexpr double kLargestTurn = 2;  // between two samples of a motion [rad]
constexpr double kMostSamples = 1e6;

enum class Type { fixed, moved, free };

/// What an entry says but for its surface.
struct Entry {
  int index = 0;
  Type type = Type::free;
  std::array<bool, 6> is_held{};  ///< x, y, z, about x, y, z
  double density = 1000;          ///< [kg/m^3]
  int group = kNoCollisionGroup;
  Vec3d position;  ///< of the origin of the mesh [m]
  Quatd turn;
  Vec3d velocity, spin;  ///< of the center of mass [m/s], world axes [rad/s]
  Load load;
  double stop = std::numeric_limits<double>::infinity();  ///< of a motion [s]
};

/// A surface in its own size, and what tells it from others.
struct Surface {
  TriangleMesh mesh;
  std::string key;
  std::string stem;
};

std::array<bool, 6> read_held(const Node& node) {
  std::array<bool, 6> held{};
  if (node.json().is_boolean()) {
    held.fill(node.boolean());
    return held;
  }
  const char* const expected =
      "must be true, false, or six of them: along x, y, z, and about x, y, z";
  if (!node.json().is_array() || node.json().size() != 6) node.refuse(expected);
  const std::vector<Node> flags = node.elements();
  for (std::size_t k = 0; k < 6; ++k) held[k] = flags[k].boolean();
  return held;
}

Entry read_entry(const Node& node, int index, const Import& in) {
  Entry entry;
  entry.index = index;
  if (const auto type = node.find("type"))
    entry.type = type->choice<Type>(
        {{"static", Type::fixed}, {"kinematic", Type::moved}, {"dynamic", Type::free}});
  if (const auto held = node.find("is_dof_fixed")) entry.is_held = read_held(*held);
  const auto& held = entry.is_held;
  if (std::all_of(held.begin(), held.end(), [](bool b) { return b; })) entry.type = Type::fixed;
  node.read("density", entry.density, kPositive, "kg/m^3");
  node.read("group_id", entry.group, -1, kRestingGroup - 1);
  node.read("position", entry.position, "m");
  const char* unit = in.dialect == Dialect::rigid_ipc ? "deg" : "rad";
  Vec3d angles;
  node.read("rotation", angles, unit);
  angles *= in.degree;
  entry.turn = exp_map(Vec3d{0, 0, angles.z}) * exp_map(Vec3d{0, angles.y, 0}) *
               exp_map(Vec3d{angles.x, 0, 0});
  node.read("linear_velocity", entry.velocity, "m/s");
  node.read("angular_velocity", entry.spin, unit);
  entry.spin *= in.degree;
  node.read("force", entry.load.force, "N");
  node.read("torque", entry.load.torque, "N m");
  entry.load.torque *= in.degree;  // rigid-ipc takes all three numbers for angles
  for (std::size_t k = 0; k < 3; ++k) {
    if (held[k]) entry.velocity[static_cast<int>(k)] = 0;
    if (held[k + 3]) entry.spin[static_cast<int>(k)] = 0;
  }
  if (const auto stop = node.find("kinematic_max_time"))
    if (!stop->json().is_null()) entry.stop = stop->number(kNonNegative, "s");
  return entry;
}

/// Vertices and faces that stand in the scene itself.
TriangleMesh read_inline(const Node& node) {
  TriangleMesh mesh;
  mesh.name = node.source().file_name + ": " + node.path();
  for (const Node& vertex :
       node.at("vertices", "a body needs a \"mesh\", or vertices and faces").elements())
    mesh.vertices.push_back(vertex.vector("m"));
  const auto last = static_cast<long long>(mesh.vertices.size()) - 1;
  if (const auto faces = node.find("faces"))
    for (const Node& face : faces->elements()) {
      if (!face.json().is_array() || face.json().size() != 3)
        face.refuse("must be three numbers of vertices");
      std::array<int, 3> triangle{};
      const std::vector<Node> corners = face.elements();
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = static_cast<int>(corners[k].integer(0, last));
      mesh.triangles.push_back(triangle);
    }
  return mesh;
}

Surface read_file(const Node& mesh, Import& in) {
  const std::string name = mesh.text();
  const auto path = find_mesh(mesh.source().base_directory, name);
  if (!path)
    mesh.refuse(
        "no such file, in the folder of the scene or in a folder \"meshes\" there or above");
  const auto [file, is_new] = in.files.try_emplace(path->string());
  if (is_new) {
    try {
      file->second = read_surface(*path);
    } catch (const InputError& error) {
      mesh.fail(error.what());
    }
    file->second.closed = is_closed(file->second);  // flat triangles may be part of that
    in.flat_triangles += drop_flat_triangles(file->second);
  }
  return {file->second, path->string(), path->stem().string()};
}

/// What the coordinates of a mesh are multiplied by.
Vec3d read_scale(const Node& node, const TriangleMesh& mesh) {
  Vec3d scale{1, 1, 1};
  if (const auto key = node.find("scale")) {
    if (key->json().is_number()) {
      const double s = key->number(kFinite, "-");
      scale = {s, s, s};
    } else {
      scale = key->vector("-");
    }
  }
  if (const auto key = node.find("dimensions")) {
    const Vec3d size = key->vector("m");
    const Box box = box_of(mesh.vertices);
    for (int k = 0; k < 3; ++k) {
      const double extent = box.high[k] - box.low[k];
      scale[k] = size[k] / (extent > 0 ? extent : 1);
    }
  }
  return scale;
}

/// Of a body that is not free: the surface about its center of mass where it moves.
reader::SharedShape resting_shape(TriangleMesh mesh, bool moves, Import& in) {
  reader::SharedShape made;
  if (moves) {
    const auto solid = moments_inside(mesh);
    const bool is_solid = mesh.triangles.size() >= kLeastTriangles && solid.volume > 0;
    made.frame.origin = is_solid ? solid.center : center_of_surface(mesh);
    for (Vec3d& v : mesh.vertices) v -= made.frame.origin;
  }
  made.shape.kind = shapes::Mesh::kind;
  made.shape.mesh = static_cast<int>(in.scene.meshes.size());
  in.scene.meshes.push_back(std::move(mesh));
  return made;
}

/// @return  nothing where the surface has no solid inside
std::optional<reader::SharedShape> free_shape(TriangleMesh mesh, Import& in) {
  if (mesh.triangles.size() < kLeastTriangles) return std::nullopt;
  if (mesh.closed && moments_of(mesh).volume < 0) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    ++in.turned_surfaces;
  }
  const auto frame = move_inside_to_principal_frame(mesh);
  if (!frame) return std::nullopt;
  reader::SharedShape made{{}, *frame};
  shapes::Mesh::measure(mesh, made.shape);
  made.shape.mesh = static_cast<int>(in.scene.meshes.size());
  in.scene.meshes.push_back(std::move(mesh));
  return made;
}

/// Poses of the center of mass, one a step, and then the velocities.
Motion posed_motion(const Node& poses, const Entry& entry, const BodyDescription& body,
                    Import& in) {
  Motion motion;
  motion.kind = Motion::Kind::sampled;
  const auto add = [&](double time, const Vec3d& position, const Quatd& turn) {
    motion.times.push_back(time);
    motion.positions.push_back(position - body.position);
    motion.orientations.push_back(turn * conjugate(body.orientation));
  };
  Vec3d position = body.position;
  Quatd turn = body.orientation;
  add(0, position, turn);
  double time = 0;
  for (const Node& pose : poses.elements()) {
    if (!pose.json().is_object()) pose.refuse("must be an object {...}");
    note_other_keys(pose, "rigid_bodies[].kinematic_poses[]", {"position", "rotation"}, in);
    time = in.h * static_cast<double>(motion.times.size());
    pose.read("position", position, "m");
    if (const auto rotation = pose.find("rotation")) turn = exp_map(rotation->vector("rad"));
    add(time, position, turn);
  }
  const double rest = std::min(entry.stop, in.end) - time;
  if (rest > 0 && (norm2(entry.velocity) > 0 || norm2(entry.spin) > 0)) {
    const double needed = 1 + std::floor(rest * norm(entry.spin) / kLargestTurn);
    if (!(needed <= kMostSamples))
      poses.fail(
          fmt::format("the body turns by {:.3g} rad after the last pose, must be {:g} or less",
                      rest * norm(entry.spin), kLargestTurn * kMostSamples));
    const int count = static_cast<int>(needed);
    for (int k = 1; k <= count; ++k) {
      const double after = rest * k / count;
      add(time + after, position + after * entry.velocity, exp_map(after * entry.spin) * turn);
    }
  }
  motion.stop = entry.stop;
  if (motion.times.size() < 2) add(in.h, position, turn);  // none at all: it rests
  return motion;
}

void set_motion(const Node& node, const Entry& entry, BodyDescription& body, Import& in) {
  if (const auto poses = node.find("kinematic_poses"); poses && !poses->elements().empty()) {
    body.motion = posed_motion(*poses, entry, body, in);
    return;
  }
  Motion motion;
  motion.kind = Motion::Kind::linear;
  motion.velocity = entry.velocity;
  motion.angular_velocity = entry.spin;
  motion.stop = entry.stop;
  body.motion = motion;
}

/// World axes, so that all of it is a matter of these; but for a single fixed axis of rotation.
std::uint8_t locks_of(const Node& node, const Entry& entry) {
  std::uint8_t locks = 0;
  int turns = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    if (!entry.is_held[k]) continue;
    locks = static_cast<std::uint8_t>(locks | (1u << k));
    if (k >= 3) ++turns;
  }
  if (turns == 1)
    node.at("is_dof_fixed", "")
        .refuse(
            "must fix none, two or three of the rotations: what one alone leaves free is not "
            "linear in "
            "the coordinates of an affine body");
  return locks;
}

[[noreturn]] void refuse_flat(const Node& node, const Surface& surface) {
  for (const char* key : {"dimensions", "scale"}) {
    const auto size = node.find(key);
    if (!size || !size->json().is_array()) continue;
    const Vec3d along = size->vector("-");
    if (along.x == 0 || along.y == 0 || along.z == 0)
      size->refuse("must not be 0 along an axis, since the body is free and must enclose a volume");
    break;  // dimensions count where both are there
  }
  const auto mesh = node.find("mesh");
  (mesh ? *mesh : node.at("vertices", ""))
      .refuse(fmt::format(
          "must enclose a volume, since the body is free: its {} triangles do not, and affine "
          "bodies "
          "without volume have no inertia against stretching; make it \"static\" or \"kinematic\", "
          "or give it a thickness",
          surface.mesh.triangles.size()));
}

void add_free(const Node& node, const Entry& entry, BodyDescription& body, Import& in) {
  ++in.free;
  body.kind = BodyKind::free;
  body.velocity = entry.velocity;
  body.angular_velocity = entry.spin;
  body.locks = locks_of(node, entry);
  set_mass_from_density(body, entry.density);
  if (norm2(entry.load.force) > 0 || norm2(entry.load.torque) > 0) body.load = entry.load;
}

/// @param scale  of the mesh
void add_body(const Node& node, const Entry& entry, const Surface& surface, const Vec3d& scale,
              Import& in) {
  if (surface.mesh.triangles.empty())
    (node.has("mesh") ? node.at("mesh", "") : node)
        .fail("holds no triangles: bodies of edges or points alone are not available");
  const std::string key = fmt::format("{}|{},{},{}|{}", surface.key, scale.x, scale.y, scale.z,
                                      static_cast<int>(entry.type));
  auto shared = in.shapes.find(key);
  if (shared == in.shapes.end()) {
    TriangleMesh mesh = surface.mesh;
    for (Vec3d& v : mesh.vertices) {
      for (int k = 0; k < 3; ++k) v[k] *= scale[k];
      if (!is_in_range(v))
        node.fail(fmt::format("a vertex of {} is more than {:g} m out", mesh.name, kFarthest));
    }
    std::optional<reader::SharedShape> made =
        entry.type == Type::free ? free_shape(std::move(mesh), in)
                                 : resting_shape(std::move(mesh), entry.type == Type::moved, in);
    if (!made) refuse_flat(node, surface);
    shared = in.shapes.emplace(key, *made).first;
  }
  BodyDescription body;
  body.entry = entry.index;
  body.shape = shared->second.shape;
  body.position = entry.position + rotate(entry.turn, shared->second.frame.origin);
  body.orientation = normalized(entry.turn * shared->second.frame.axes);
  body.collision_group = entry.group;
  body.group = entry.type == Type::free ? 0 : 1;
  if (const auto poses = node.find("kinematic_poses");
      poses && entry.type != Type::moved && !poses->elements().empty())
    ++in.not_used["rigid_bodies[].kinematic_poses of a body that is not kinematic"];
  switch (entry.type) {
    case Type::free:
      add_free(node, entry, body, in);
      break;
    case Type::fixed:
      ++in.fixed;
      body.kind = BodyKind::fixed;
      break;
    case Type::moved:
      ++in.moved;
      body.kind = BodyKind::kinematic;
      set_motion(node, entry, body, in);
      break;
  }
  const TriangleMesh& mesh = in.scene.meshes[static_cast<std::size_t>(body.shape.mesh)];
  std::vector<Vec3d> corners;
  corners.reserve(mesh.vertices.size() + 2);
  for (const Vec3d& v : mesh.vertices)
    corners.push_back(body.position + rotate(body.orientation, v));
  if (in.world) corners.insert(corners.end(), {in.world->low, in.world->high});
  in.world = box_of(corners);
  in.bodies[surface.stem].push_back(
      {static_cast<int>(in.scene.bodies.size()), scale, entry.position, entry.turn});
  in.scene.bodies.push_back(std::move(body));
}

/// The body of a constraint, by the stem of its mesh.
const NamedBody& body_of(const Node& node, const char* key, const Import& in) {
  const Node name = node.at(key, "must be the name of a mesh without its ending");
  const auto found = in.bodies.find(name.text());
  if (found == in.bodies.end()) {
    std::vector<std::string> known;
    for (const auto& [stem, bodies] : in.bodies) known.push_back(stem);
    name.refuse("must be the name of the mesh of a body, without folder and ending" +
                reader::nearest_hint(name.text(), known));
  }
  if (found->second.size() > 1)
    name.refuse(
        fmt::format("must be the name of one body: {} have this mesh", found->second.size()));
  return found->second[0];
}

Vec3d point_of_mesh(const Node& node, const char* key, const NamedBody& body) {
  Vec3d point = node.at(key, "must be a point of the mesh, [x, y, z]").vector("m");
  for (int k = 0; k < 3; ++k) point[k] *= body.scale[k];
  return body.position + rotate(body.turn, point);
}

}  // namespace

void read_ipc_body(const Node& node, int index, Import& in) {
  note_other_keys(node, "rigid_bodies[]",
                  {"mesh",
                   "vertices",
                   "edges",
                   "faces",
                   "density",
                   "enabled",
                   "type",
                   "is_dof_fixed",
                   "oriented",
                   "group_id",
                   "position",
                   "rotation",
                   "scale",
                   "dimensions",
                   "linear_velocity",
                   "angular_velocity",
                   "force",
                   "torque",
                   "kinematic_max_time",
                   "kinematic_poses",
                   "split_components",
                   "ipc_comparison_enabled"},
                  in);
  bool is_enabled = true, is_split = false;
  node.read("enabled", is_enabled);
  if (!is_enabled) {
    ++in.disabled;
    return;
  }
  node.read("split_components", is_split);
  const Entry entry = read_entry(node, index, in);
  const auto file = node.find("mesh");
  Surface surface = file ? read_file(*file, in)
                         : Surface{read_inline(node), fmt::format("inline|{}", index),
                                   fmt::format("body-{}", index)};
  if (!file) {
    surface.mesh.closed = is_closed(surface.mesh);
    in.flat_triangles += drop_flat_triangles(surface.mesh);
  }
  if (surface.mesh.vertices.empty())
    (file ? *file : node.at("vertices", "")).fail("holds no vertices");
  const Vec3d scale = read_scale(node, surface.mesh);
  if (!is_split) {
    add_body(node, entry, surface, scale, in);
    return;
  }
  int number = 0;
  for (TriangleMesh& part : components(surface.mesh)) {
    part.closed = is_closed(part);
    Surface piece{std::move(part), fmt::format("{}|part {}", surface.key, number++), surface.stem};
    add_body(node, entry, piece, scale, in);
  }
  if (number == 0) add_body(node, entry, surface, scale, in);  // which refuses it
}

void read_ipc_constraint(const Node& node, Import& in) {
  const Node type = node.at("type", "must be \"pin_world\" or \"pin_joint\"");
  const bool is_pair = type.choice<bool>({{"pin_world", false}, {"pin_joint", true}});
  note_other_keys(node, "linear_constraints[]",
                  is_pair
                      ? std::vector<std::string>{"type", "bodyA_name", "bodyA_point", "bodyB_name"}
                      : std::vector<std::string>{"type", "body_name", "body_point"},
                  in);
  Joint joint;
  joint.kind = JointKind::ball;
  const NamedBody& first = body_of(node, is_pair ? "bodyA_name" : "body_name", in);
  joint.anchor = point_of_mesh(node, is_pair ? "bodyA_point" : "body_point", first);
  joint.bodies = {is_pair ? body_of(node, "bodyB_name", in).id : kWorldBody, first.id};
  const auto is_free = [&](int id) {
    return id != kWorldBody && in.scene.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free;
  };
  if (!is_free(joint.bodies[0]) && !is_free(joint.bodies[1])) {
    in.notes.push_back(fmt::format("{} is not used: no body of it is free", node.path()));
    return;
  }
  in.scene.joints.push_back(joint);
}

}  // namespace scree::ipc
