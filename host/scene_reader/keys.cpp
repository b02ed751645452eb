#include "host/scene_reader/keys.h"

#include <algorithm>
#include <stdexcept>

#include "dynamics/dynamics_card.h"
#include "shapes/shape_card.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

std::vector<std::string> solver_keys() {
  std::vector<std::string> keys{"name",       "stop",  "max_iterations",      "check_every",
                                "warm_start", "model", "max_outer_iterations"};
  for (const auto& [parameter, solvers] : solver_parameters()) keys.emplace_back(parameter.key);
  return keys;
}

void add_new(const std::string& key, std::vector<std::string>& keys) {
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
}

template <class Fits>
std::vector<std::string> keys_of_shapes(Fits fits) {
  std::vector<std::string> keys;
  for (const ShapeCard& card : shape_cards())
    if (fits(card))
      for (const ShapeKey& own : card.keys) add_new(own.key, keys);
  return keys;
}

std::vector<std::string> body_keys() {
  std::vector<std::string> keys = shape_keys();
  keys.insert(keys.begin(), {"name", "shape", "kind"});
  for (const char* key : {"position", "orientation", "rotation_deg", "velocity", "angular_velocity",
                          "mass", "density", "inertia", "material", "group", "collision_group",
                          "lock", "force", "torque", "elastic", "motion", "insert_at"})
    keys.emplace_back(key);
  return keys;
}

std::vector<std::string> free_shape_keys() {
  return keys_of_shapes([](const ShapeCard& card) { return card.may_be_free(); });
}

std::vector<std::string> particle_keys() {
  std::vector<std::string> keys = own_particle_keys();
  for (const std::string& key : free_shape_keys()) add_new(key, keys);
  return keys;
}

std::vector<std::string> particle_shape_keys() {
  std::vector<std::string> keys = free_shape_keys();
  keys.insert(keys.begin(), {"shape", "weight", "group"});
  return keys;
}

std::vector<std::string> shape_part_keys() {
  std::vector<std::string> keys =
      keys_of_shapes([](const ShapeCard& card) { return card.may_be_part(); });
  keys.insert(keys.begin(), "shape");
  for (const char* key : {"position", "orientation", "rotation_deg"}) keys.emplace_back(key);
  return keys;
}

std::vector<std::string> dynamics_keys() {
  std::vector<std::string> keys{"type"};
  for (const DynamicsCard& card : dynamics_cards())
    for (const SolverParameter& parameter : card.parameters) keys.emplace_back(parameter.key);
  return keys;
}

}  // namespace

std::vector<std::string> shape_keys() {
  return keys_of_shapes([](const ShapeCard&) { return true; });
}

const std::vector<std::string>& own_particle_keys() {
  static const std::vector<std::string> keys{
      "layout",       "count",    "radius",           "shape", "shapes",
      "scale",        "density",  "material",         "group", "orientation",
      "rotation_deg", "velocity", "angular_velocity", "lock",  "region",
      "spacing",      "jitter",   "layers",           "rate",  "start",
      "interval",     "file",     "velocity_spread"};
  return keys;
}

const std::vector<KeyTable>& scene_key_tables() {
  static const std::vector<KeyTable> tables{
      {"scene", {"$schema",   "name",      "gravity",   "seed",           "backend",  "precision",
                 "time_step", "duration",  "materials", "material_pairs", "periodic", "bodies",
                 "urdf",      "particles", "joints",    "attachments",    "dynamics", "solver",
                 "stepping",  "collision", "output"}},
      {"material",
       {"friction", "restitution", "cohesion", "rolling_friction", "spinning_friction"}},
      {"material_pair",
       {"between", "friction", "restitution", "cohesion", "rolling_friction", "spinning_friction"}},
      {"periodic", {"x", "y", "z"}},
      {"body", body_keys()},
      {"rotation", {"axis", "angle"}},
      {"elasticity", {"young_modulus", "poisson_ratio"}},
      {"attachment", {"body", "to", "box"}},
      {"motion",
       {"type", "velocity", "angular_velocity", "axis", "center", "rate", "amplitude", "frequency",
        "phase", "start", "stop", "times", "positions", "orientations", "file"}},
      {"joint",
       {"type", "bodies", "anchor", "axis", "anchors", "second_axis", "length", "limits", "motor",
        "friction", "turn", "second_turn", "swing", "swing_axis", "stiffness", "damping",
        "break_force", "break_moment"}},
      {"joint_turn", {"limits", "motor", "friction"}},
      {"urdf",
       {"file", "name", "position", "orientation", "rotation_deg", "velocity", "angular_velocity",
        "fixed_base", "material", "group", "links", "joint_positions", "motors"}},
      {"urdf_link", {"material", "group"}},
      {"joint_motor",
       {"speed", "position", "stiffness", "damping", "max_force", "torque", "force"}},
      {"particles", particle_keys()},
      {"particle_shape", particle_shape_keys()},
      {"shape_part", shape_part_keys()},
      {"radius", {"min", "max", "values", "weights", "normal"}},
      {"radius_normal", {"mean", "deviation", "min", "max"}},
      {"region", {"min", "max", "cylinder"}},
      {"cylinder", {"axis", "center", "radius", "length"}},
      {"dynamics", dynamics_keys()},
      {"solver", solver_keys()},
      {"stepping", {"max_recovery_speed", "restitution_law", "restitution_threshold"}},
      {"collision", {"envelope", "skin"}},
      {"output",
       {"frame_interval", "frame_pieces", "checkpoint_interval", "force_interval", "contact_frames",
        "surface_frames", "picture"}},
      {"picture", {"interval", "width", "height", "color_by", "color_range", "labels", "camera"}},
      {"camera", {"position", "target", "up", "vertical_angle_deg"}},
  };
  return tables;
}

const KeyTable& scene_keys(const std::string& object) {
  for (const KeyTable& table : scene_key_tables())
    if (table.object == object) return table;
  throw std::logic_error("no key table " + object);
}

}  // namespace scree
