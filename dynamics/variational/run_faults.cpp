#include "dynamics/variational/run_faults.h"

#include <fmt/format.h>

#include "host/error.h"

namespace scree {

void throw_overlap(int body, const Vec3d& x, double depth) {
  throw InputError(fmt::format(
      "body {} at ({:g}, {:g}, {:g}) m overlaps another body or a wall by {:g} m: bodies of the "
      "dynamics \"variational\" must start apart",
      body, x.x, x.y, x.z, depth));
}

void throw_resting(std::int64_t step, int body, double speed) {
  throw RunError(
      fmt::format("step {}: body {} comes to rest: it leaves a wall slower than {:g} m/s, half of "
                  "what it falls in "
                  "a step. The dynamics \"variational\" has no resting contact; \"rigid\" has, and "
                  "a smaller time "
                  "step goes on for longer",
                  step, body, speed));
}

void throw_stuck(std::int64_t step, int body) {
  throw RunError(fmt::format(
      "step {}: body {} touches another body or a wall and neither approaches nor leaves it. The "
      "dynamics \"variational\" has no resting contact; \"rigid\" has",
      step, body));
}

void throw_crowded(std::int64_t step, int body, double most) {
  throw RunError(fmt::format(
      "step {}: body {} has more than {:g} impacts in the step: it rests on something, is held "
      "between "
      "bodies, or the time step is too large (dynamics.max_impacts says how many are allowed). The "
      "dynamics \"variational\" has no resting contact; \"rigid\" has",
      step, body, most));
}

void throw_spinning(std::int64_t step, int body, double turn, double most) {
  throw RunError(
      fmt::format("step {}: body {} turns by {:g} rad in the step; at most {:g} are solved: take a "
                  "smaller time "
                  "step",
                  step, body, turn, most));
}

void throw_step_too_long(std::int64_t step, double time_step, const Vec3d& period) {
  const bool is_periodic = period.x > 0 || period.y > 0 || period.z > 0;
  throw RunError(fmt::format(
      "step {}: bodies go too far in a step of {:g} s{}; take a smaller time step", step, time_step,
      is_periodic ? fmt::format(" for the periods ({:g}, {:g}, {:g}) m, of which a body may "
                                "cross a quarter, less its radius",
                                period.x, period.y, period.z)
                  : ""));
}

}  // namespace scree
