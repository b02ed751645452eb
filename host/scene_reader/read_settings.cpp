// Everything in a scene that is not a body: parameters, output and materials.

#include <fmt/format.h>

#include <limits>
#include <tuple>

#include "dynamics/dynamics_card.h"
#include "host/scene_reader/parts.h"
#include "solvers/solver_card.h"

namespace scree::reader {
namespace {

constexpr int kMaxInt = std::numeric_limits<int>::max();

void read_stop(const Node& node, StopRule& stop) {
  if (node.json().is_number()) {
    stop.level = StopRule::Level::absolute;
    stop.residual = node.number(kPositive, "m/s");
  } else if (node.json().is_string()) {
    using Level = StopRule::Level;
    stop.level = node.choice<Level>({{"quality", Level::quality},
                                     {"preview", Level::preview},
                                     {"fixed", Level::fixed_iterations}});
  } else {
    node.refuse("must be \"quality\", \"preview\", \"fixed\" or a residual [m/s]");
  }
}

double read_parameter(const Node& node, const SolverParameter& parameter) {
  if (parameter.choices.empty()) {
    const std::string expected = parameter.expected();
    const double value = node.number(
        {parameter.low, parameter.high, !parameter.is_low_allowed, true, expected.c_str()}, "");
    if (!parameter.allows(value)) node.refuse(expected);
    return value;
  }
  std::vector<std::pair<std::string, double>> named;
  for (const char* name : parameter.choices)
    named.emplace_back(name, static_cast<double>(named.size()));
  return node.choice(named);
}

void read_solver(const Node& node, SolverSettings& solver) {
  node.check_keys(scene_keys("solver"));
  if (const auto name = node.find("name")) {
    std::vector<std::pair<std::string, std::string>> names;
    for (const std::string& each : solver_names()) names.emplace_back(each, each);
    solver.name = name->choice(names);
  }
  if (const auto stop = node.find("stop")) read_stop(*stop, solver.stop);
  node.read("max_iterations", solver.max_iterations, 1, kMaxInt);
  node.read("check_every", solver.check_every, 1, kMaxInt);
  node.read("warm_start", solver.warm_start);
  if (const auto model = node.find("model"))
    solver.exact_coulomb = model->choice<bool>({{"convex", false}, {"exact", true}});
  node.read("max_outer_iterations", solver.max_outer_iterations, 1, kMaxInt);
  for (const auto& [parameter, solvers] : solver_parameters())
    if (const auto value = node.find(parameter.key))
      solver.parameters[parameter.key] = read_parameter(*value, parameter);
}

void read_camera(const Node& node, CameraSettings& camera) {
  if (node.json().is_string()) {
    node.choice<int>({{"automatic", 0}});
    return;
  }
  node.check_keys(scene_keys("camera"));
  camera.automatic = false;
  camera.position = node.at("position", "must be three numbers [x, y, z] [m]").vector("m");
  camera.target = node.at("target", "must be three numbers [x, y, z] [m]").vector("m");
  if (const auto up = node.find("up")) camera.up = up->direction();
  constexpr Range angle{0, 170, true, true, "must be between 0 and 170, both excluded"};
  node.read("vertical_angle_deg", camera.vertical_angle, angle, "deg");
}

void read_picture(const Node& node, PictureSettings& picture) {
  if (node.json().is_boolean()) {
    picture.interval = node.boolean() ? 0 : -1;
    return;
  }
  node.check_keys(scene_keys("picture"));
  node.read("interval", picture.interval, kNonNegative, "s");
  node.read("width", picture.width, 16, 16384);
  node.read("height", picture.height, 16, 16384);
  if (const auto color = node.find("color_by"))
    picture.color_by = color->choice<ColorBy>({{"speed", ColorBy::speed},
                                               {"size", ColorBy::size},
                                               {"id", ColorBy::id},
                                               {"group", ColorBy::group}});
  if (const auto range = node.find("color_range"))
    std::tie(picture.color_min, picture.color_max) = range->interval("");
  node.read("labels", picture.labels);
  if (const auto camera = node.find("camera")) read_camera(*camera, picture.camera);
}

void read_periodicity(const Node& node, Periodicity& box) {
  node.check_keys(scene_keys("periodic"));
  for (int k = 0; k < 3; ++k) {
    const auto axis = node.find(std::string(1, "xyz"[k]));
    if (!axis) continue;
    box.periodic[static_cast<std::size_t>(k)] = true;
    std::tie(box.lower[k], box.upper[k]) = axis->interval("m");
  }
}

void read_material_values(const Node& node, Material& material) {
  node.read("friction", material.friction, kNonNegative, "-");
  node.read("restitution", material.restitution, kFraction, "-");
  node.read("cohesion", material.cohesion, kNonNegative, "N");
  node.read("rolling_friction", material.rolling_friction, kNonNegative, "m");
  node.read("spinning_friction", material.spinning_friction, kNonNegative, "m");
}

}  // namespace

void read_dynamics(const Node& node, DynamicsSettings& dynamics) {
  if (const auto type = node.find("type")) {
    std::vector<std::pair<std::string, std::string>> names;
    for (const std::string& each : dynamics_names()) names.emplace_back(each, each);
    dynamics.type = type->choice(names);
  }
  KeyTable known{"dynamics", {"type"}};
  const DynamicsCard& card = dynamics_card(dynamics.type);
  for (const SolverParameter& parameter : card.parameters) known.keys.emplace_back(parameter.key);
  node.check_keys(known);
  for (const SolverParameter& parameter : card.parameters)
    if (const auto value = node.find(parameter.key))
      dynamics.parameters[parameter.key] = read_parameter(*value, parameter);
}

void read_output(const Node& node, OutputSettings& output) {
  node.check_keys(scene_keys("output"));
  node.read("frame_interval", output.frame_interval, kNonNegative, "s");
  node.read("frame_pieces", output.frame_pieces);
  node.read("checkpoint_interval", output.checkpoint_interval, kNonNegative, "s");
  node.read("force_interval", output.force_interval, kNonNegative, "s");
  node.read("contact_frames", output.contact_frames);
  node.read("surface_frames", output.surface_frames);
  if (const auto picture = node.find("picture")) read_picture(*picture, output.picture);
}

void read_settings(const Node& node, Scene& scene) {
  if (const auto name = node.find("name")) scene.name = name->text();
  node.read("gravity", scene.gravity, "m/s^2");
  if (const auto seed = node.find("seed"))
    scene.seed =
        static_cast<std::uint64_t>(seed->integer(0, std::numeric_limits<long long>::max()));
  if (const auto backend = node.find("backend"))
    scene.backend =
        backend->choice<std::string>({{"auto", "auto"}, {"cpu", "cpu"}, {"cuda", "cuda"}});
  if (const auto precision = node.find("precision"))
    scene.precision = precision->choice<std::string>({{"float", "float"}, {"double", "double"}});
  scene.stepping.time_step = node.at("time_step", "must be positive [s]").number(kPositive, "s");
  scene.stepping.duration =
      node.at("duration", "must be zero or positive [s]").number(kNonNegative, "s");
  if (const auto periodic = node.find("periodic")) read_periodicity(*periodic, scene.periodicity);
  if (const auto dynamics = node.find("dynamics")) read_dynamics(*dynamics, scene.dynamics);
  if (const auto solver = node.find("solver")) read_solver(*solver, scene.solver);
  if (const auto stepping = node.find("stepping")) {
    stepping->check_keys(scene_keys("stepping"));
    stepping->read("max_recovery_speed", scene.stepping.max_recovery_speed, kNonNegative, "m/s");
    if (const auto law = stepping->find("restitution_law"))
      scene.stepping.restitution_law = law->choice<RestitutionLaw>(
          {{"poisson", RestitutionLaw::poisson}, {"newton", RestitutionLaw::newton}});
    stepping->read("restitution_threshold", scene.stepping.restitution_threshold, kNonNegative,
                   "m/s");
  }
  if (const auto collision = node.find("collision")) {
    collision->check_keys(scene_keys("collision"));
    collision->read("envelope", scene.stepping.envelope, kNonNegative, "m");
    collision->read("skin", scene.stepping.skin, kNonNegative, "m");
  }
  if (const auto output = node.find("output")) read_output(*output, scene.output);
}

void read_materials(const Node& node, Draft& draft) {
  if (const auto materials = node.find("materials")) {
    draft.scene.materials.clear();
    for (const auto& [name, values] : materials->members()) {
      values.check_keys(scene_keys("material"));
      Material material;
      material.name = name;
      read_material_values(values, material);
      draft.scene.materials.push_back(material);
    }
    if (draft.scene.materials.empty()) materials->refuse("must hold one material or more");
    if (draft.scene.materials.size() > kMostMaterials)
      materials->fail(fmt::format("{} materials are not allowed: must be {} or fewer",
                                  draft.scene.materials.size(), kMostMaterials));
  }
  for (const Material& material : draft.scene.materials)
    draft.material_of_name.emplace(material.name, static_cast<int>(draft.material_of_name.size()));
  if (const auto pairs = node.find("material_pairs")) {
    for (const Node& entry : pairs->elements()) {
      entry.check_keys(scene_keys("material_pair"));
      const char* expected = "must be two names of materials";
      const Node between = entry.at("between", expected);
      const std::vector<Node> names = between.elements();
      if (names.size() != 2) between.refuse(expected);
      MaterialPair pair;
      pair.material_a = material_index(names[0], names[0].text(), draft);
      pair.material_b = material_index(names[1], names[1].text(), draft);
      // Values that the entry does not give keep their mix.
      pair.values = pair_values(draft.scene, pair.material_a, pair.material_b);
      read_material_values(entry, pair.values);
      draft.scene.material_pairs.push_back(pair);
    }
  }
}

int material_index(const Node& node, const std::string& name, const Draft& draft) {
  const auto found = draft.material_of_name.find(name);
  if (found != draft.material_of_name.end()) return found->second;
  std::vector<std::string> known;
  for (const Material& material : draft.scene.materials) known.push_back(material.name);
  std::string list;
  for (const std::string& each : known) list += (list.empty() ? "" : ", ") + each;
  node.fail("\"" + name + "\" is not allowed: must be a name of materials: " + list +
            nearest_hint(name, known));
}

int read_material(const Node& node, const Draft& draft) {
  if (const auto material = node.find("material"))
    return material_index(*material, material->text(), draft);
  const auto found = draft.material_of_name.find("default");
  return found == draft.material_of_name.end() ? 0 : found->second;
}

int group_index(const std::string& name, Draft& draft) {
  std::vector<std::string>& groups = draft.scene.groups;
  if (draft.group_of_name.empty())  // those that every scene has
    for (const std::string& known : groups)
      draft.group_of_name.emplace(known, static_cast<int>(draft.group_of_name.size()));
  const auto [entry, is_new] = draft.group_of_name.emplace(name, static_cast<int>(groups.size()));
  if (is_new) groups.push_back(name);
  return entry->second;
}

std::uint8_t read_locks(const Node& node) {
  const std::vector<std::pair<std::string, int>> names{{"x", lock_x},
                                                       {"y", lock_y},
                                                       {"z", lock_z},
                                                       {"rx", lock_rx},
                                                       {"ry", lock_ry},
                                                       {"rz", lock_rz},
                                                       {"rotation", lock_rotation}};
  if (node.json().is_string()) return static_cast<std::uint8_t>(node.choice(names));
  unsigned bits = 0;
  for (const Node& entry : node.elements()) bits |= static_cast<unsigned>(entry.choice(names));
  return static_cast<std::uint8_t>(bits);
}

}  // namespace scree::reader
