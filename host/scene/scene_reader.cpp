#include "host/scene_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include "dynamics/dynamics_card.h"
#include "host/error.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene_reader/ipc_scene.h"
#include "host/scene_reader/parts.h"
#include "solvers/solver_card.h"

namespace scree {

using namespace reader;

namespace {

std::string read_text(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(file.string() + ": no such file");
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw InputError(file.string() + ": cannot be read");
  return text;
}

Json document(const std::string& text, Source& source, const std::vector<std::string>& overrides) {
  Json json = parse_json(text, source.file_name);
  for (const std::string& text_of_one : overrides)
    source.overridden.push_back(apply_override(json, text_of_one));
  return json;
}

/// Notes parameters of other solvers.
void note_other_parameters(const Node& solver, const std::string& name, Draft& draft) {
  for (const auto& [parameter, able] : solver_parameters())
    if (solver.has(parameter.key) && std::find(able.begin(), able.end(), name) == able.end())
      draft.notes.push_back(fmt::format("solver.{} has no effect: \"{}\" has none, these have: {}",
                                        parameter.key, name, fmt::join(able, ", ")));
}

/// Notes what a valid scene says that changes nothing.
void note_without_effect(const Node& root, Draft& draft) {
  const Scene& scene = draft.scene;
  if (!dynamics_card(scene.dynamics.type).has_contacts) {
    for (const char* key : {"solver", "stepping", "collision"})
      if (root.find(key))
        draft.notes.push_back(fmt::format(
            "\"{}\" has no effect: the dynamics \"{}\" have keys of their own in \"dynamics\"", key,
            scene.dynamics.type));
  } else if (const auto solver = root.find("solver")) {
    note_other_parameters(*solver, scene.solver.name, draft);
  }
  // Layers of a rain are batches of one entry, of which some may come.
  std::map<std::string, std::size_t> late;
  for (const Insertion& insertion : scene.insertions) {
    if (!(insertion.time > scene.stepping.duration)) continue;
    for (const BodyDescription& body : insertion.bodies)
      ++late[fmt::format("bodies[{}]", body.entry)];
    for (const ParticleSet& set : insertion.particles)
      late[fmt::format("particles[{}]", set.entry)] += set.position.size();
  }
  for (const auto& [entry, count] : late)
    draft.notes.push_back(fmt::format("{} {} of {} would come after the end of the run, {:g} s",
                                      count, count == 1 ? "body" : "bodies", entry,
                                      scene.stepping.duration));
}

/// Notes a duration that does not end with a step, but for the digits of one third.
void note_whole_steps(Draft& draft) {
  const SteppingSettings& s = draft.scene.stepping;
  const double steps = s.duration / s.time_step, taken = std::round(steps);
  if (!(taken > 0) || std::abs(steps - taken) <= 0.01) return;
  draft.notes.push_back(fmt::format("duration: {:g} s are {:g} steps of {:g} s: {:g} are taken",
                                    s.duration, steps, s.time_step, taken));
}

/// What is up in pictures of scenes that do not place the camera: the axis that points most against gravity. Floors of slopes,
/// where gravity is turned instead, stay level.
void turn_camera(Scene& scene) {
  CameraSettings& camera = scene.output.picture.camera;
  if (!camera.automatic) return;
  int axis = 2;
  for (int k = 0; k < 2; ++k)
    if (std::abs(scene.gravity[k]) > std::abs(scene.gravity[axis])) axis = k;
  camera.up = {};
  camera.up[axis] = scene.gravity[axis] > 0 ? -1 : 1;
}

/// Gives the scene the names of its bodies, now that their ids are known.
void name_bodies(Draft& draft) {
  if (draft.entry_of_name.empty()) return;
  std::vector<int> id_of_entry(draft.body_of_entry.size(), -1);
  for_each_by_id(
      draft.scene,
      [&](std::size_t id, const BodyDescription& body) {
        if (body.entry >= 0)  // not of a URDF file
          id_of_entry.at(static_cast<std::size_t>(body.entry)) = static_cast<int>(id);
      },
      [](std::size_t, const ParticleSet&) {});
  for (const auto& [name, entry] : draft.entry_of_name)
    draft.scene.body_names[name] = id_of_entry[entry];
}

void validate_read(const Scene& scene, const Source& source) {
  try {
    validate(scene);
  } catch (const InputError& fault) {
    throw InputError(placed_fault(source, fault.what()));
  }
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& file_name,
                  const std::filesystem::path& base_directory,
                  const std::vector<std::string>& overrides, std::vector<std::string>* notes) {
  Source source{file_name, base_directory, {}};
  const Json json = document(text, source, overrides);
  const Node root(json, "", source);
  if (ipc::is_ipc_scene(json)) {
    std::vector<std::string> told;
    Scene scene = ipc::read_ipc_scene(root, told);
    validate_read(scene, source);
    if (notes != nullptr) *notes = std::move(told);
    return scene;
  }
  root.check_keys(scene_keys("scene"));

  if (const auto schema = root.find("$schema")) schema->text();
  Draft draft;
  read_settings(root, draft.scene);
  read_materials(root, draft);
  if (const auto bodies = root.find("bodies")) {
    const std::vector<Node> entries = bodies->elements();
    for (std::size_t i = 0; i < entries.size(); ++i) read_body(entries[i], i, draft);
  }
  if (const auto models = root.find("urdf"))
    for (const Node& entry : models->elements()) read_urdf_entry(entry, draft);
  if (const auto particles = root.find("particles")) {
    const std::vector<Node> entries = particles->elements();
    for (std::size_t i = 0; i < entries.size(); ++i) read_particles(entries[i], i, draft);
  }
  if (const auto joints = root.find("joints"))
    for (const Node& entry : joints->elements()) read_joint(entry, draft);
  if (const auto attachments = root.find("attachments"))
    for (const Node& entry : attachments->elements()) read_attachment(entry, draft);
  draft.scene.insertions.reserve(draft.inserted.size());
  for (auto& [time, insertion] : draft.inserted) {
    insertion.time = time;
    draft.scene.insertions.push_back(std::move(insertion));
  }
  name_bodies(draft);
  validate_read(draft.scene, source);
  note_without_effect(root, draft);
  note_whole_steps(draft);
  turn_camera(draft.scene);
  if (notes != nullptr) *notes = std::move(draft.notes);
  return std::move(draft.scene);
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                 std::vector<std::string>* notes) {
  return parse_scene(read_text(file), file.string(), file.parent_path(), overrides, notes);
}

std::string scene_fault(const std::filesystem::path& file,
                        const std::vector<std::string>& overrides, const std::string& fault) {
  Source source{file.string(), file.parent_path(), {}};
  document(read_text(file), source, overrides);
  return placed_fault(source, fault);
}

std::string scene_text(const std::filesystem::path& file,
                       const std::vector<std::string>& overrides) {
  Source source{file.string(), file.parent_path(), {}};
  const Json json = document(read_text(file), source, overrides);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace scree
