#include "host/engine/roster.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "host/body_constants.h"
#include "host/error.h"
#include "host/scene/added_bodies.h"
#include "host/scene/joint_cards.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"

namespace scree {
namespace {

// Values of an added body in the arrays of a state.
// Kind of its shape, open faces, mesh, material, group, locks, kind of the core of a rounded shape.
constexpr std::size_t kIntegers = 7;
// Radius and volume of its shape, mass, radius and shift of a rounded shape.
constexpr std::size_t kNumbers = 5;
// Position, velocity, angular velocity, inertia; of its shape: half extents, normal, moments.
constexpr std::size_t kVectors = 7;

[[noreturn]] void refuse_state(const std::string& what) {
  throw InputError("checkpoint: bodies that a program added or removed: " + what);
}

int first_added(const Scene& scene) {
  return static_cast<int>(count_bodies(scene).all() - added_count(scene));
}

/// Texts of faults in a scene call an added body by its place in the list of insertions.
std::string with_ids(std::string text, const Scene& scene) {
  const std::string place = fmt::format("insertions[{}].bodies[", timed_insertions(scene));
  for (std::size_t at = text.find(place); at != std::string::npos; at = text.find(place, at)) {
    const std::size_t number = at + place.size(), end = text.find(']', number);
    if (end == std::string::npos) break;
    const std::string id =
        fmt::format("body {}", first_added(scene) + std::stoi(text.substr(number, end - number)));
    text.replace(at, end + 1 - at, id);
    at += id.size();
  }
  return text;
}

const char* held_by(const Scene& scene, std::size_t joint) {
  return joint_card(scene.joints[joint].kind).name;
}

ShapeKind saved_kind(std::int32_t number) {
  const auto kind = static_cast<ShapeKind>(number);
  if (static_cast<std::int32_t>(kind) != number)
    refuse_state(fmt::format("shape number {} is not known", number));
  return kind;
}

BodyDescription saved_body(const std::int32_t* n, const double* x, const Vec3d* v,
                           const Quatd& orientation) {
  BodyDescription body;
  body.shape.kind = saved_kind(n[0]);
  body.shape.open_faces = static_cast<unsigned>(n[1]);
  body.shape.mesh = n[2];
  body.material = n[3];
  body.group = n[4];
  body.locks = static_cast<std::uint8_t>(n[5]);
  body.shape.rounded = {saved_kind(n[6]), x[3], x[4]};
  body.shape.radius = x[0], body.shape.volume = x[1], body.mass = x[2];
  body.position = v[0], body.velocity = v[1], body.angular_velocity = v[2], body.inertia = v[3];
  body.shape.half_extents = v[4], body.shape.normal = v[5], body.shape.moments = v[6];
  body.orientation = orientation;
  return body;
}

std::vector<BodyDescription> saved_bodies(const WorldState& s) {
  if (!s.has("added/orientation")) return {};
  const std::vector<Quatd>& orientation = s.at<Quatd>("added/orientation");
  const std::size_t count = orientation.size();
  const auto& integers = s.at<std::int32_t>("added/integer");
  const auto& numbers = s.at<double>("added/number");
  const auto& vectors = s.at<Vec3d>("added/vector");
  if (integers.size() != kIntegers * count || numbers.size() != kNumbers * count ||
      vectors.size() != kVectors * count)
    refuse_state(fmt::format("{}, {} and {} values of {} bodies", integers.size(), numbers.size(),
                             vectors.size(), count));
  std::vector<BodyDescription> bodies;
  for (std::size_t k = 0; k < count; ++k)
    bodies.push_back(saved_body(&integers[kIntegers * k], &numbers[kNumbers * k],
                                &vectors[kVectors * k], orientation[k]));
  return bodies;
}

/// A name for each body, empty where it has none. Rows of the array: number of the body, length, letters.
std::vector<std::string> saved_names(const WorldState& s, std::size_t count) {
  std::vector<std::string> names(count);
  if (!s.has("added/name")) return names;
  const std::vector<std::int32_t>& rows = s.at<std::int32_t>("added/name");
  for (std::size_t k = 0; k < rows.size();) {
    const bool has_head = rows.size() - k >= 2;
    const std::int32_t body = has_head ? rows[k] : -1, length = has_head ? rows[k + 1] : 0;
    if (body < 0 || static_cast<std::size_t>(body) >= count || length < 1 ||
        static_cast<std::size_t>(length) > rows.size() - k - 2)
      refuse_state(fmt::format("row {} of their names is not one", k));
    for (std::int32_t c = 0; c < length; ++c)
      names[static_cast<std::size_t>(body)] +=
          static_cast<char>(rows[k + 2 + static_cast<std::size_t>(c)]);
    k += 2 + static_cast<std::size_t>(length);
  }
  return names;
}

}  // namespace

bool Roster::is_removed(int id) const {
  return std::binary_search(removed_.begin(), removed_.end(), id);
}

void Roster::check() const {
  try {
    validate(scene_);
  } catch (const InputError& error) {
    throw InputError(with_ids(error.what(), scene_));
  }
}

std::vector<int> Roster::add(const std::vector<BodyDescription>& bodies,
                             const std::vector<std::string>& names) {
  const auto first = static_cast<int>(count_bodies(scene_).all());
  std::vector<int> ids;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const int id = first + static_cast<int>(k);
    const std::string path = fmt::format("add(): body {}", id);
    BodyDescription body = bodies[k];
    body.entry = -1;
    if (body.kind != BodyKind::free)
      throw InputError(fault_text(path + ".kind", "a fixed or kinematic body",
                                  "only free bodies can be added during a run"));
    if (const auto fault = body_fault(scene_, body))
      throw InputError(fault_text(fault->field.empty() ? path : path + "." + fault->field,
                                  fault->value, fault->expected));
    added_bodies(scene_).push_back(body);
    if (k < names.size() && !names[k].empty()) {
      if (names[k] == kWorldName)
        throw InputError(fault_text(path + ".name", '"' + names[k] + '"',
                                    "stands for what bodies are fixed to"));
      const auto [place, is_new] = scene_.body_names.emplace(names[k], id);
      if (!is_new)
        throw InputError(fault_text(path + ".name", '"' + names[k] + '"',
                                    fmt::format("body {} has that name", place->second)));
    }
    ids.push_back(id);
  }
  try {
    check();
  } catch (const InputError& error) {
    throw InputError(std::string("add(): ") + error.what());
  }
  return ids;
}

void Roster::remove(int id) {
  for (std::size_t k = 0; k < scene_.joints.size(); ++k)
    for (const int held : scene_.joints[k].bodies)
      if (held == id)
        throw InputError(fmt::format(
            "remove(): body {} is held by joints[{}], a {}; bodies of joints cannot be removed", id,
            k, held_by(scene_, k)));
  removed_.insert(std::lower_bound(removed_.begin(), removed_.end(), id), id);
  for (auto name = scene_.body_names.begin(); name != scene_.body_names.end();) {
    if (name->second != id) {
      ++name;
      continue;
    }
    if (id < first_added(scene_)) lost_names_.insert(*name);
    name = scene_.body_names.erase(name);
  }
}

void Roster::save(WorldState& s) const {
  if (!removed_.empty()) s.add("added/removed", removed_);
  if (added_count(scene_) == 0) return;
  std::vector<std::int32_t> integers, names;
  std::vector<double> numbers;
  std::vector<Vec3d> vectors;
  std::vector<Quatd> orientations;
  const auto append = [](auto& to, const auto& rows) {
    to.insert(to.end(), rows.begin(), rows.end());
  };
  for (const BodyDescription& body : scene_.insertions.back().bodies) {
    const Shape& shape = body.shape;
    append(integers, std::array<std::int32_t, kIntegers>{
                         static_cast<std::int32_t>(shape.kind),
                         static_cast<std::int32_t>(shape.open_faces), shape.mesh, body.material,
                         body.group, body.locks, static_cast<std::int32_t>(shape.rounded.core)});
    append(numbers, std::array<double, kNumbers>{shape.radius, shape.volume, body.mass,
                                                 shape.rounded.radius, shape.rounded.shift});
    append(vectors, std::array<Vec3d, kVectors>{body.position, body.velocity, body.angular_velocity,
                                                body.inertia, shape.half_extents, shape.normal,
                                                shape.moments});
    orientations.push_back(body.orientation);
  }
  for (const auto& [name, id] : scene_.body_names) {
    if (id < first_added(scene_)) continue;
    names.push_back(id - first_added(scene_));
    names.push_back(static_cast<std::int32_t>(name.size()));
    for (const char c : name) names.push_back(static_cast<unsigned char>(c));
  }
  s.add("added/integer", std::move(integers));
  s.add("added/number", std::move(numbers));
  s.add("added/vector", std::move(vectors));
  s.add("added/orientation", std::move(orientations));
  if (!names.empty()) s.add("added/name", std::move(names));
}

Roster Roster::restored(const WorldState& s) const {
  Roster next = *this;
  next.removed_.clear();
  if (added_count(scene_) > 0) {
    std::erase_if(next.scene_.body_names,
                  [&](const auto& name) { return name.second >= first_added(scene_); });
    next.scene_.insertions.pop_back();
  }
  for (const auto& name : std::exchange(next.lost_names_, {})) next.scene_.body_names.insert(name);
  const std::vector<BodyDescription> bodies = saved_bodies(s);
  // Names that bodies of the scene had may be those of added ones now, so removals come first.
  const int scene_end = static_cast<int>(count_bodies(next.scene_).all());
  std::vector<int> removed;
  if (s.has("added/removed")) removed = s.at<std::int32_t>("added/removed");
  const BodyConstants constants(next.scene_);
  for (const int id : removed) {
    const bool is_known = id >= 0 && id < scene_end + static_cast<int>(bodies.size());
    if (!is_known || next.is_removed(id) ||
        (id < scene_end && constants[static_cast<std::size_t>(id)].kind != BodyKind::free))
      refuse_state(fmt::format("body {} cannot have been removed", id));
    next.remove(id);
  }
  if (!bodies.empty()) next.add(bodies, saved_names(s, bodies.size()));
  return next;
}

bool Roster::has_changes() const { return !removed_.empty() || added_count(scene_) > 0; }

bool has_changed_bodies(const WorldState& s) {
  return s.has("added/removed") || s.has("added/orientation");
}

}  // namespace scree
