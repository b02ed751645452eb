#include "dynamics/model_errors.h"

#include <fmt/format.h>

#include "host/error.h"
#include "kernels/bodies/range.h"
#include "kernels/contact/contact_key.h"

namespace scree {

void throw_bad_body(std::int64_t step, int body, const Vec3d& x, const Vec3d& v) {
  const bool finite = is_finite(x) && is_finite(v);
  throw RunError(fmt::format(
      "step {}: body {} {}: position ({}, {}, {}) m, velocity ({}, {}, {}) m/s; "
      "the time step may be too large",
      step, body,
      finite
          ? fmt::format("is too far out or too fast, beyond {:g} m, or {:g} m/s or {:g} m a step",
                        kFarthest, kFastest, kFarthest)
          : "has a state that is not finite",
      x.x, x.y, x.z, v.x, v.y, v.z));
}

void throw_bad_load(std::int64_t step, int body) {
  throw RunError(
      fmt::format("step {}: the force or torque on body {} is not finite, or changes its speed by "
                  "more than {:g} "
                  "m/s or rad/s in a step",
                  step, body, kFastest));
}

void throw_bad_written(int body, const Vec3d& x, const Quatd& q, const Vec3d& v, const Vec3d& w) {
  throw InputError(fmt::format(
      "body {}: position ({}, {}, {}) m, orientation ({}, {}, {}, {}), velocity ({}, {}, {}) m/s, "
      "angular velocity ({}, {}, {}) rad/s was written to its arrays; expected finite values, "
      "positions up to {:g} m, speeds up to {:g} m/s and an orientation that is not zero",
      body, x.x, x.y, x.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z, kFarthest, kFastest));
}

void throw_unknown_array(const std::string& name, const std::vector<ArrayInfo>& known) {
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const ArrayInfo& info : known) names.push_back(info.name);
  throw InputError(
      fmt::format("array \"{}\" is not known; expected one of {}", name, fmt::join(names, ", ")));
}

void throw_not_finite(std::int64_t step, const char* quantity, double value) {
  throw RunError(fmt::format(
      "step {}: the {} is {}; values of the scene may be too large or too small, or the time step "
      "too large",
      step, quantity, value));
}

void throw_bad_contact(std::int64_t step, int body_a, int body_b) {
  throw RunError(
      fmt::format("step {}: the contact of bodies {} and {} has a residual that is not finite; the "
                  "time step may be too "
                  "large or a body's state is broken",
                  step, body_a, body_b));
}

void throw_wrong_model(const std::string& found, const std::string& expected) {
  throw InputError(
      fmt::format("checkpoint: it is of dynamics \"{}\", the scene has \"{}\"", found, expected));
}

void require_joints(std::size_t found, std::size_t in_scene) {
  if (found != 2 * in_scene)
    throw InputError(
        fmt::format("checkpoint: {} vectors of joint impulses, expected {} of {} joints", found,
                    2 * in_scene, in_scene));
}

void require_joint_states(std::size_t positions, std::size_t broken, std::size_t in_scene) {
  if (positions != in_scene || broken != in_scene)
    throw InputError(
        fmt::format("checkpoint: {} positions and {} marks of broken joints, expected {} of each",
                    positions, broken, in_scene));
}

void throw_untracked_forces(const char* call) {
  throw InputError(fmt::format("{} needs track_forces() before the steps", call));
}

void require_gravity(const Vec3d& g, double time_step) {
  if (is_in_range(g) && is_speed_in_range(time_step * norm(g), time_step)) return;
  throw InputError(fmt::format(
      "set_gravity(): ({}, {}, {}) is not allowed: must move a body by {:g} m at most in a step of "
      "{:g} s [m/s^2]",
      g.x, g.y, g.z, kFarthest, time_step));
}

Vec3d saved_gravity(const WorldState& s, double time_step) {
  const std::vector<Vec3d>& rows = s.at<Vec3d>("world/gravity");
  if (rows.size() != 1 || !is_speed_in_range(time_step * norm(rows[0]), time_step))
    throw InputError("checkpoint: world/gravity must be one vector that bodies can follow");
  return rows[0];
}

void require_velocity(int body, const Vec3d& v, const Vec3d& w, double time_step) {
  if (is_speed_in_range(norm(v), time_step) && is_speed_in_range(norm(w), time_step)) return;
  throw InputError(fmt::format(
      "set_velocity(): ({}, {}, {}) m/s and ({}, {}, {}) rad/s of body {} are not allowed: must be "
      "{:g} m/s or rad/s at most, and {:g} m in a step of {:g} s",
      v.x, v.y, v.z, w.x, w.y, w.z, body, kFastest, kFarthest, time_step));
}

void require_load(int body, const Vec3d& f, const Vec3d& t) {
  if (is_finite(f) && is_finite(t)) return;
  throw InputError(fmt::format(
      "apply_force(): ({}, {}, {}) N and ({}, {}, {}) N m on body {} are not allowed: must be "
      "finite numbers",
      f.x, f.y, f.z, t.x, t.y, t.z, body));
}

void throw_no_force(int body) {
  throw InputError(fmt::format(
      "force_on(): body {} is free: give it a group of its own, and ask for that", body));
}

void throw_wrong_insertions(std::uint64_t found, std::size_t in_scene) {
  throw InputError(
      fmt::format("checkpoint: {} insertions done, the scene has {}", found, in_scene));
}

void throw_wrong_body_count(std::size_t found, std::size_t expected) {
  throw InputError(
      fmt::format("checkpoint: {} free bodies, the scene has {} at that time", found, expected));
}

void throw_bad_earlier_step() {
  throw InputError("checkpoint: affine/earlier_step must be one time above 0");
}

void throw_bad_near_list() {
  throw InputError(
      "checkpoint: affine/near_list must be a time from 0 to 1, a room above 0, and three numbers "
      "of steps, the second 0 or more, the others 1 or more");
}

void throw_bad_led_part() {
  throw InputError(
      "checkpoint: affine/led_part must be a part of a step from 0 to 1, and one above 0");
}

void throw_no_room_for_bodies(std::int64_t wanted, std::int64_t room) {
  throw RunError(
      fmt::format("{} free bodies and ghosts on a rank, which can number {}", wanted, room));
}

void throw_too_many_peers(std::size_t found) {
  throw RunError(fmt::format(
      "bodies of one rank may meet those of {} others, at most 64 are possible: use fewer ranks",
      found));
}

void throw_unknown_body(int id) {
  throw InputError(fmt::format("checkpoint: body {} is not a free body of the scene", id));
}

void throw_unknown_contact(std::size_t contact, int body_a, int body_b, std::uint64_t feature) {
  throw InputError(
      fmt::format("checkpoint: contact {} has body_a {}, body_b {} and feature {}, which is no "
                  "contact of bodies of the scene",
                  contact, body_a, body_b, feature));
}

void require_impulses(std::size_t found, std::size_t expected) {
  if (found != expected)
    throw InputError(
        fmt::format("checkpoint: {} vectors of contact impulses, expected {}", found, expected));
}

void require_contact_rows(std::initializer_list<std::size_t> found, std::size_t expected) {
  for (const std::size_t rows : found)
    if (rows != expected)
      throw InputError(fmt::format("checkpoint: {} rows of contacts, expected {}", rows, expected));
}

void require_places(const std::vector<std::uint64_t>& keys, std::int64_t owned_count) {
  for (std::size_t c = 0; c < keys.size(); ++c)
    if (contact_body(keys[c]) >= owned_count || contact_body(keys[c]) < 0)
      throw InputError(
          fmt::format("checkpoint: contact {} is of storage place {}, expected 0 to {}", c,
                      contact_body(keys[c]), owned_count - 1));
}

}  // namespace scree
