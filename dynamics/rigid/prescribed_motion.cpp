#include "dynamics/rigid/prescribed_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "dynamics/rigid/wall_periods.h"
#include "host/error.h"
#include "host/scene/scene_checks.h"

namespace scree {
namespace {

// Rows of a motion in the arrays of a checkpoint.
constexpr std::size_t kVectors = 4;  // velocity, angular velocity, axis, center
// Begin, rate, amplitude, frequency, phase, start, stop, samples, orientations among these.
constexpr std::size_t kNumbers = 9;

[[noreturn]] void refuse_saved(const std::string& what) {
  throw InputError("checkpoint: motion of bodies: " + what);
}

/// Takes rows of an array one after the other.
template <class T>
class Rows {
 public:
  explicit Rows(const WorldState& s, const char* name) : name_(name), left_(s.at<T>(name)) {}
  /// @param count  as checkpoints have it
  std::span<const T> take(double count) {
    if (!(count >= 0 && count <= static_cast<double>(left_.size())))
      refuse_saved(fmt::format("{} rows of {}, which has {} more", count, name_, left_.size()));
    const auto size = static_cast<std::size_t>(count);
    const std::span<const T> rows = left_.first(size);
    left_ = left_.subspan(size);
    return rows;
  }
  bool is_empty() const { return left_.empty(); }

 private:
  const char* name_;
  std::span<const T> left_;
};

template <class T>
std::vector<T> copied(std::span<const T> rows) {
  return {rows.begin(), rows.end()};
}

/// @param of_scene  the body as the scene has it
/// @throws InputError when it cannot move like that
void require_motion(const Scene& scene, int id, const BodyDescription& of_scene,
                    const BodyDescription& body, bool may_turn) {
  auto fault = body_fault(scene, body);
  if (!fault) fault = periodic_wall_fault(scene, body);
  if (fault)
    throw InputError(
        fault_text(fmt::format("body {}: {}", id, fault->field), fault->value, fault->expected));
  if (turns(body.motion) && !may_turn)
    throw InputError(fmt::format(
        "body {}: a motion that turns is not allowed: contacts of this scene have no lever arms, "
        "since none of its walls turns; let one of them be \"rotating\" with rate 0",
        id));
  if ((axes_it_goes_on(scene, of_scene) & ~axes_it_goes_on(scene, body)) != 0)
    throw InputError(fmt::format(
        "body {}: a motion that turns it like this is not allowed: it goes on over the periodic "
        "sides; it may turn about the axis that repeats",
        id));
}

Motion motion_of(std::int32_t kind, std::span<const Vec3d> v, std::span<const double> x) {
  if (kind < 0 || kind > static_cast<int>(Motion::Kind::sampled))
    refuse_saved(fmt::format("kind {} is not known", kind));
  Motion m;
  m.kind = static_cast<Motion::Kind>(kind);
  m.velocity = v[0], m.angular_velocity = v[1], m.axis = v[2], m.center = v[3];
  m.rate = x[1], m.amplitude = x[2], m.frequency = x[3], m.phase = x[4];
  m.start = x[5], m.stop = x[6];
  return m;
}

}  // namespace

PrescribedMotion::PrescribedMotion(const Scene& scene) : time_step_(scene.stepping.time_step) {
  for (std::size_t id = 0; id < scene.bodies.size(); ++id) {
    const BodyDescription& body = scene.bodies[id];
    if (body.kind == BodyKind::free) continue;
    walls_.push_back({static_cast<int>(id), {body}});
    has_motion_ = has_motion_ || body.kind == BodyKind::kinematic;
  }
}

const PrescribedMotion::Wall& PrescribedMotion::kinematic(int body) const {
  const auto place = std::lower_bound(walls_.begin(), walls_.end(), body,
                                      [](const Wall& wall, int id) { return wall.id < id; });
  if (place == walls_.end() || place->id != body || place->course.body.kind != BodyKind::kinematic)
    throw InputError(
        fmt::format("body {} is not kinematic: only kinematic bodies have a motion", body));
  return *place;
}

void PrescribedMotion::replace(const Scene& scene, int body, const Motion& motion, double now,
                               bool may_turn) {
  const Wall& wall = kinematic(body);
  const auto own = replaced_.find(body);
  Course next = own == replaced_.end() ? wall.course : own->second;
  const Pose pose = next.at(now);
  next.body.position = pose.position;
  next.body.orientation = pose.orientation;
  next.body.motion = motion;
  next.since = now;
  require_motion(scene, body, wall.course.body, next.body, may_turn);
  replaced_[body] = std::move(next);
}

void PrescribedMotion::save(WorldState& s) const {
  if (replaced_.empty()) return;
  std::vector<std::int32_t> ids, kinds;
  std::vector<Vec3d> positions, vectors, sample_positions;
  std::vector<Quatd> orientations, sample_orientations;
  std::vector<double> numbers, sample_times;
  const auto append = [](auto& to, const auto& rows) {
    to.insert(to.end(), rows.begin(), rows.end());
  };
  for (const auto& [id, course] : replaced_) {
    const Motion& m = course.body.motion;
    ids.push_back(id);
    kinds.push_back(static_cast<std::int32_t>(m.kind));
    positions.push_back(course.body.position);
    orientations.push_back(course.body.orientation);
    append(vectors, std::array{m.velocity, m.angular_velocity, m.axis, m.center});
    append(numbers,
           std::array<double, kNumbers>{course.since, m.rate, m.amplitude, m.frequency, m.phase,
                                        m.start, m.stop, static_cast<double>(m.times.size()),
                                        static_cast<double>(m.orientations.size())});
    append(sample_times, m.times);
    append(sample_positions, m.positions);
    append(sample_orientations, m.orientations);
  }
  s.add("motion/body", std::move(ids));
  s.add("motion/kind", std::move(kinds));
  s.add("motion/position", std::move(positions));
  s.add("motion/orientation", std::move(orientations));
  s.add("motion/vectors", std::move(vectors));
  s.add("motion/numbers", std::move(numbers));
  s.add("motion/sample_time", std::move(sample_times));
  s.add("motion/sample_position", std::move(sample_positions));
  s.add("motion/sample_orientation", std::move(sample_orientations));
}

void PrescribedMotion::restore(const Scene& scene, const WorldState& s, bool may_turn) {
  std::map<int, Course> saved;
  if (s.has("motion/body")) {
    Rows<std::int32_t> ids(s, "motion/body"), kinds(s, "motion/kind");
    Rows<Vec3d> positions(s, "motion/position"), vectors(s, "motion/vectors"),
        sample_positions(s, "motion/sample_position");
    Rows<Quatd> orientations(s, "motion/orientation"),
        sample_orientations(s, "motion/sample_orientation");
    Rows<double> numbers(s, "motion/numbers"), sample_times(s, "motion/sample_time");
    while (!ids.is_empty()) {
      const int id = ids.take(1)[0];
      const std::span<const double> x = numbers.take(kNumbers);
      Motion m = motion_of(kinds.take(1)[0], vectors.take(kVectors), x);
      m.times = copied(sample_times.take(x[7]));
      m.positions = copied(sample_positions.take(x[7]));
      m.orientations = copied(sample_orientations.take(x[8]));
      Course course = kinematic(id).course;
      course.body.position = positions.take(1)[0];
      course.body.orientation = orientations.take(1)[0];
      course.body.motion = std::move(m);
      course.since = x[0];
      if (!std::isfinite(course.since)) refuse_saved("a time that is not finite");
      require_motion(scene, id, kinematic(id).course.body, course.body, may_turn);
      saved[id] = std::move(course);
    }
  }
  replaced_ = std::move(saved);
}

}  // namespace scree
