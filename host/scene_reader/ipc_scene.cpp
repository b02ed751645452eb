#include "host/scene_reader/ipc_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host/error.h"
#include "host/scene_reader/ipc_import.h"

namespace scree::ipc {
namespace {

using reader::kFinite;
using reader::kNonNegative;
using reader::kPositive;

constexpr int kMaxInt = std::numeric_limits<int>::max();
constexpr int kDefaultSteps = 1000;
constexpr double kAutodeskStiffness = 5e9;  // [Pa]

/// Whether anything in the file is only in scenes of Autodesk's program.
bool is_autodesk(const Node& problem) {
  if (problem.has("orthogonality_stiffness") || problem.has("linear_constraints")) return true;
  const auto bodies = problem.find("rigid_bodies");
  if (!bodies || !bodies->json().is_array()) return false;
  for (const Node& body : bodies->elements())
    if (const auto mesh = body.json().is_object() ? body.find("mesh") : std::nullopt)
      if (mesh->json().is_string() &&
          mesh->json().get_ref<const std::string&>().find('\\') != std::string::npos)
        return true;
  return false;
}

void read_dialect(const Node& root, const Node& problem, Import& in) {
  in.dialect = is_autodesk(problem) ? Dialect::autodesk : Dialect::rigid_ipc;
  if (const auto dialect = root.find("dialect"))
    in.dialect = dialect->choice<Dialect>(
        {{"rigid-ipc", Dialect::rigid_ipc}, {"autodesk", Dialect::autodesk}});
  in.degree = in.dialect == Dialect::rigid_ipc ? std::numbers::pi / 180 : 1;
}

void read_times(const Node& root, Import& in) {
  root.read("timestep", in.h, kPositive, "s");
  long long steps = kDefaultSteps;
  double time = -1;
  root.read("max_time", time, kFinite, "s");
  if (const auto key = root.find("max_iterations"))
    if (const long long most = key->integer(-1, kMaxInt); most >= 0) steps = most;
  // The time counts where both are given. A hair less, so that 0.3 s in steps of 0.1 s are three of them.
  if (time >= 0) steps = std::llround(std::ceil(std::min(time / in.h, 1e15) * (1 - 1e-12)));
  in.scene.stepping.time_step = in.h;
  in.end = static_cast<double>(steps) * in.h;
  in.scene.stepping.duration = in.end;
}

/// The object of that key, if it is there; other keys in it than these are noted.
std::optional<Node> part(const Node& root, const char* key, const std::vector<std::string>& known,
                         Import& in) {
  auto node = root.find(key);
  if (node) note_other_keys(*node, key, known, in);
  return node;
}

void note_other_value(const std::optional<Node>& node, const char* key, const char* expected,
                      const char* instead, Import& in) {
  if (!node) return;
  if (const auto value = node->find(key))
    if (value->json() != expected)
      in.notes.push_back(
          fmt::format("{} {} is not available: {}", value->path(), value->json().dump(), instead));
}

void read_contact(const Node& root, Import& in) {
  auto& parameters = in.scene.dynamics.parameters;
  double reach = 1e-3, separation = 0;
  const auto barrier = part(root, "distance_barrier_constraint",
                            {"initial_barrier_activation_distance", "minimum_separation_distance",
                             "trajectory_type", "detection_method", "barrier_type"},
                            in);
  if (barrier) {
    barrier->read("initial_barrier_activation_distance", reach, kPositive, "m");
    barrier->read("minimum_separation_distance", separation, kNonNegative, "m");
    note_other_value(barrier, "barrier_type", "ipc", "it runs with \"ipc\"", in);
  }
  parameters["reach"] = reach;
  if (separation > 0) parameters["separation"] = separation;
}

/// @param world  diagonal of the box about all bodies at the start [m]
void read_newton(const Node& root, double world, Import& in) {
  auto& parameters = in.scene.dynamics.parameters;
  double tolerance = 1e-2;
  bool is_absolute = false;
  // Keys of `newton_solver` hold for `ipc_solver` too.
  for (const char* name : {"newton_solver", "ipc_solver"}) {
    const auto newton =
        part(root, name,
             {"velocity_conv_tol", "is_velocity_conv_tol_abs", "max_iterations", "dhat_epsilon",
              "min_barrier_stiffness_scale", "convergence_criteria", "energy_conv_tol",
              "is_energy_conv_tol_abs", "line_search_lower_bound", "linear_solver"},
             in);
    if (!newton) continue;
    newton->read("velocity_conv_tol", tolerance, kPositive, "-");
    newton->read("is_velocity_conv_tol_abs", is_absolute);
    if (const auto most = newton->find("max_iterations"))
      parameters["max_iterations"] = static_cast<double>(most->integer(1, kMaxInt));
    note_other_value(newton, "convergence_criteria", "velocity", "steps end by \"velocity\"", in);
  }
  parameters["tolerance"] = tolerance * (is_absolute ? 1 : world);
}

void read_friction(const Node& root, const Node& problem, Import& in) {
  auto& parameters = in.scene.dynamics.parameters;
  double slip_speed = 1e-3;
  long long solves = 1;
  if (const auto friction =
          part(root, "friction_constraints", {"static_friction_speed_bound", "iterations"}, in)) {
    friction->read("static_friction_speed_bound", slip_speed, kPositive, "m/s");
    if (const auto count = friction->find("iterations")) solves = count->integer(-1, kMaxInt);
  }
  Material material;
  material.friction = 0;
  problem.read("coefficient_friction", material.friction, kNonNegative, "-");
  if (solves == 0) material.friction = 0;
  in.scene.materials = {material};
  parameters["slip_speed"] = slip_speed;
  parameters["friction_solves"] = solves < 0 ? 0.0 : std::max(1.0, static_cast<double>(solves));
}

void read_problem(const Node& problem, Import& in) {
  note_other_keys(problem, "rigid_body_problem",
                  {"gravity", "coefficient_friction", "coefficient_restitution", "collision_eps",
                   "time_stepper", "do_intersection_check", "rigid_bodies",
                   "orthogonality_stiffness", "linear_constraints"},
                  in);
  in.scene.gravity = {0, 0, 0};
  problem.read("gravity", in.scene.gravity, "m/s^2");
  if (in.dialect == Dialect::autodesk)
    in.scene.dynamics.parameters["stiffness"] = kAutodeskStiffness;
  if (const auto stiffness = problem.find("orthogonality_stiffness"))
    in.scene.dynamics.parameters["stiffness"] = stiffness->number(kPositive, "Pa");
  if (const auto restitution = problem.find("coefficient_restitution"))
    if (restitution->number(kFinite, "-") > 0)
      in.notes.push_back(fmt::format("{} {} is not used: contacts do not bounce",
                                     restitution->path(), restitution->json().dump()));
  if (const auto stepper = problem.find("time_stepper"))
    if (stepper->json() != "default" && stepper->json() != "implicit_euler")
      in.notes.push_back(fmt::format("{} {} is not available: it runs with \"implicit_euler\"",
                                     stepper->path(), stepper->json().dump()));
  const Node bodies = problem.at("rigid_bodies", "must be a list of bodies");
  int index = 0;
  for (const Node& body : bodies.elements()) read_ipc_body(body, index++, in);
  if (in.free + in.fixed + in.moved == 0) bodies.refuse("must have one body or more");
  if (const auto constraints = problem.find("linear_constraints"))
    for (const Node& constraint : constraints->elements()) read_ipc_constraint(constraint, in);
}

/// Keys of scenes of this program, which say the last word.
void read_own_keys(const Node& root, Import& in) {
  Scene& scene = in.scene;
  std::filesystem::path file = root.source().file_name;
  scene.name = file.stem().empty() ? "scene" : file.stem().string();
  if (const auto name = root.find("name")) scene.name = name->text();
  if (const auto backend = root.find("backend"))
    scene.backend =
        backend->choice<std::string>({{"auto", "auto"}, {"cpu", "cpu"}, {"cuda", "cuda"}});
  if (const auto precision = root.find("precision"))
    scene.precision = precision->choice<std::string>({{"float", "float"}, {"double", "double"}});
  if (const auto dynamics = root.find("dynamics")) {
    if (const auto type = dynamics->find("type"))
      if (type->json() != "affine") type->refuse("must be \"affine\", or absent");
    read_dynamics(*dynamics, scene.dynamics);
  }
  if (const auto output = root.find("output")) read_output(*output, scene.output);
}

/// Bodies have the names of their meshes, with a number where there are several.
void name_bodies(Import& in) {
  for (const auto& [stem, bodies] : in.bodies) {
    int number = 0;
    for (const NamedBody& body : bodies) {
      ++number;
      const std::string name = bodies.size() == 1 ? stem : fmt::format("{}.{}", stem, number);
      in.scene.body_names.emplace(name, body.id);
    }
  }
}

void tell(const Import& in, std::vector<std::string>& notes) {
  std::string counts =
      fmt::format("{} free, {} fixed, {} moved bodies", in.free, in.fixed, in.moved);
  if (in.disabled > 0) counts += fmt::format(", {} left out", in.disabled);
  notes.push_back(in.dialect == Dialect::rigid_ipc
                      ? fmt::format("a scene of rigid-ipc, angles in degrees: {}", counts)
                      : fmt::format("a scene of Autodesk's Affine Body Dynamics, angles in "
                                    "radians: {}, {} joints",
                                    counts, in.scene.joints.size()));
  if (in.flat_triangles > 0)
    notes.push_back(fmt::format("{} triangles without area are left out", in.flat_triangles));
  if (in.turned_surfaces > 0)
    notes.push_back(
        fmt::format("{} surfaces that are inside out are turned over", in.turned_surfaces));
  std::string keys;
  for (const auto& [path, count] : in.not_used)
    keys += fmt::format("{}{}{}", keys.empty() ? "" : ", ", path,
                        count > 1 ? fmt::format(" ({} times)", count) : "");
  if (!keys.empty()) notes.push_back("unknown keys, not used: " + keys);
  notes.insert(notes.end(), in.notes.begin(), in.notes.end());
}

}  // namespace

bool is_ipc_scene(const reader::Json& document) {
  return document.is_object() && document.contains("rigid_body_problem");
}

void note_other_keys(const Node& object, const std::string& path,
                     const std::vector<std::string>& known, Import& in) {
  for (const auto& [key, value] : object.members()) {
    if (key.empty() || key[0] == '#') continue;
    if (std::find(known.begin(), known.end(), key) == known.end())
      ++in.not_used[fmt::format("{}{}{}", path, path.empty() ? "" : ".", key)];
  }
}

Scene read_ipc_scene(const Node& root, std::vector<std::string>& notes) {
  Import in;
  note_other_keys(
      root, "",
      {"scene_type", "solver", "timestep", "max_time", "max_iterations", "viewport_bbox",
       "distance_barrier_constraint", "newton_solver", "ipc_solver", "friction_constraints",
       "rigid_body_problem", "dialect", "name", "backend", "precision", "dynamics", "output"},
      in);
  const Node problem = root.at("rigid_body_problem", "must be an object {...}");
  in.scene.dynamics.type = "affine";
  in.scene.dynamics.parameters["rule"] = 0;  // implicit Euler
  in.scene.precision = "double";
  in.scene.groups = {"bodies", "walls"};
  if (const auto type = root.find("scene_type"))
    if (type->json() != "distance_barrier_rb_problem")
      in.notes.push_back(
          fmt::format("scene_type {} is not available: it runs as "
                      "\"distance_barrier_rb_problem\"",
                      type->json().dump()));
  read_dialect(root, problem, in);
  read_times(root, in);
  read_contact(root, in);
  read_friction(root, problem, in);
  read_problem(problem, in);
  read_newton(root, norm(in.world->high - in.world->low), in);
  name_bodies(in);
  read_own_keys(root, in);
  tell(in, notes);
  return std::move(in.scene);
}

}  // namespace scree::ipc
