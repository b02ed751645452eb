// Values that are numbers, but that no run can compute with.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/scene/motion.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"
#include "kernels/bodies/range.h"

namespace scree {
namespace {

constexpr double kHeaviest = 1e24;  // [kg]
constexpr double kLightest = 1e-24;
constexpr double kMostInertia = 1e36;  // of a shape whose moments are inverted in Real [kg m^2]
constexpr double kLeastInertia = 1e-36;
constexpr double kMostFriction = 1e6;  // [-], and for the lengths of rolling and spinning [m]
constexpr double kMostCohesion = 1e15;
constexpr double kShortestStep = 1e-15;  // [s]
constexpr double kLongestStep = 1e9;
constexpr double kMostSteps = 1e15;  // step numbers and their times stay exact

Fault out_of_range(const std::string& field, double value, double low, double high,
                   const char* unit) {
  return {field, fmt::format("{}", value),
          fmt::format("must be from {:g} to {:g} [{}]", low, high, unit)};
}

Fault too_far(const std::string& field, const Vec3d& value, const char* unit) {
  return {field, vector_text(value),
          fmt::format("must be numbers from {:g} to {:g} [{}]", -kFarthest, kFarthest, unit)};
}

bool lies_between(double value, double low, double high) { return value >= low && value <= high; }

std::optional<Fault> speed_fault(const Scene& scene, const BodyDescription& body) {
  const double h = scene.stepping.time_step;
  const auto too_fast = [&](const char* field, const Vec3d& rates, const char* unit) {
    return Fault{field, vector_text(rates),
                 fmt::format("must move the body by {:g} m/s at most, and by {:g} m in a step of "
                             "{:g} s [{}]",
                             kFastest, kFarthest, h, unit)};
  };
  if (!is_speed_in_range(norm(body.velocity), h)) return too_fast("velocity", body.velocity, "m/s");
  const double radius = bounding_radius(scene, body);
  const double spin = norm(body.angular_velocity);
  if (!is_speed_in_range(radius * spin, h) || !(spin <= kFastest))
    return too_fast("angular_velocity", body.angular_velocity, "rad/s");
  return std::nullopt;
}

std::optional<Fault> mass_fault(const BodyDescription& body) {
  if (!lies_between(body.mass, kLightest, kHeaviest))
    return out_of_range("mass", body.mass, kLightest, kHeaviest, "kg");
  if (shape_card(body.shape.kind).is_ball) return std::nullopt;  // its moments need no matrix
  for (int k = 0; k < 3; ++k)
    if (!lies_between(body.inertia[k], kLeastInertia, kMostInertia))
      return out_of_range("inertia", body.inertia[k], kLeastInertia, kMostInertia, "kg m^2");
  return std::nullopt;
}

/// What a motion is made of, and the speed it begins with.
std::optional<Fault> motion_range_fault(const BodyDescription& body, double h) {
  const Motion& motion = body.motion;
  if (motion.kind == Motion::Kind::none) return std::nullopt;
  if (!is_in_range(motion.velocity)) return too_far("motion.velocity", motion.velocity, "m/s");
  if (!is_in_range(motion.angular_velocity))
    return too_far("motion.angular_velocity", motion.angular_velocity, "rad/s");
  if (!is_in_range(motion.center)) return too_far("motion.center", motion.center, "m");
  const std::pair<const char*, double> numbers[] = {{"rate", motion.rate},
                                                    {"amplitude", motion.amplitude},
                                                    {"frequency", motion.frequency},
                                                    {"phase", motion.phase}};
  for (const auto& [key, value] : numbers)
    if (!(std::abs(value) <= kFarthest))
      return Fault{std::string("motion.") + key, fmt::format("{}", value),
                   fmt::format("must be a number from {:g} to {:g}", -kFarthest, kFarthest)};
  for (std::size_t i = 0; i < motion.positions.size(); ++i)
    if (!is_in_range(motion.positions[i]))
      return too_far(fmt::format("motion.positions[{}]", i), motion.positions[i], "m");
  const Pose start = pose_at(body, 0);
  const Rates rates = rates_between(start, pose_at(body, h), h);
  if (!is_in_range(start.position) || !is_speed_in_range(norm(rates.velocity), h))
    return Fault{"motion",
                 fmt::format("a start at {} m with {} m/s", vector_text(start.position),
                             vector_text(rates.velocity)),
                 fmt::format("must begin within {:g} m of the origin, at {:g} m/s or less",
                             kFarthest, kFastest)};
  return std::nullopt;
}

/// Largest values of a material.
std::optional<Fault> material_fault(const std::string& path, const Material& m) {
  struct Limit {
    const char* key;
    double value;
    double most;
    const char* unit;
  };
  const Limit limits[] = {{"friction", m.friction, kMostFriction, "-"},
                          {"cohesion", m.cohesion, kMostCohesion, "N"},
                          {"rolling_friction", m.rolling_friction, kMostFriction, "m"},
                          {"spinning_friction", m.spinning_friction, kMostFriction, "m"}};
  for (const Limit& limit : limits)
    if (!(limit.value <= limit.most))
      return out_of_range(path + "." + limit.key, limit.value, 0, limit.most, limit.unit);
  return std::nullopt;
}

std::optional<Fault> stepping_fault(const Scene& scene) {
  const SteppingSettings& s = scene.stepping;
  if (!lies_between(s.time_step, kShortestStep, kLongestStep))
    return out_of_range("time_step", s.time_step, kShortestStep, kLongestStep, "s");
  if (!(s.duration / s.time_step <= kMostSteps))
    return Fault{"duration", fmt::format("{}", s.duration),
                 fmt::format("would take {:.3g} steps of {:g} s, must be {:g} steps or fewer",
                             s.duration / s.time_step, s.time_step, kMostSteps)};
  if (!is_in_range(scene.gravity)) return too_far("gravity", scene.gravity, "m/s^2");
  if (!is_speed_in_range(s.time_step * norm(scene.gravity), s.time_step))
    return Fault{"gravity", vector_text(scene.gravity),
                 fmt::format("must move a body by {:g} m at most in a step of {:g} s [m/s^2]",
                             kFarthest, s.time_step)};
  struct Limit {
    const char* key;
    double value;
    const char* unit;
  };
  const Limit limits[] = {{"stepping.max_recovery_speed", s.max_recovery_speed, "m/s"},
                          {"stepping.restitution_threshold", s.restitution_threshold, "m/s"},
                          {"collision.envelope", s.envelope, "m"},
                          {"collision.skin", s.skin, "m"}};
  for (const Limit& limit : limits)  // a negative envelope or skin means the default
    if (!(limit.value <= kFarthest))
      return out_of_range(limit.key, limit.value, 0, kFarthest, limit.unit);
  const Periodicity& box = scene.periodicity;
  for (int k = 0; k < 3; ++k)
    if (box.periodic[static_cast<std::size_t>(k)] &&
        !(std::abs(box.lower[k]) <= kFarthest && std::abs(box.upper[k]) <= kFarthest))
      return Fault{fmt::format("periodic.{}", "xyz"[k]),
                   fmt::format("[{}, {}]", box.lower[k], box.upper[k]),
                   fmt::format("must be numbers from {:g} to {:g} [m]", -kFarthest, kFarthest)};
  return std::nullopt;
}

}  // namespace

std::optional<Fault> range_fault(const Scene& scene, const BodyDescription& body) {
  const double h = scene.stepping.time_step;
  if (!is_in_range(body.position)) return too_far("position", body.position, "m");
  if (body.kind != BodyKind::free) return motion_range_fault(body, h);
  if (auto fault = speed_fault(scene, body)) return fault;
  return mass_fault(body);
}

std::optional<Fault> range_fault(const Scene& scene) {
  if (auto fault = stepping_fault(scene)) return fault;
  for (const Material& m : scene.materials)
    if (auto fault = material_fault("materials." + m.name, m)) return fault;
  for (std::size_t i = 0; i < scene.material_pairs.size(); ++i)
    if (auto fault =
            material_fault(fmt::format("material_pairs[{}]", i), scene.material_pairs[i].values))
      return fault;
  for (const TriangleMesh& mesh : scene.meshes)
    for (const Vec3d& vertex : mesh.vertices)
      if (!is_in_range(vertex)) return too_far(mesh.name, vertex, "m");
  return std::nullopt;
}

}  // namespace scree
