#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host/scene/motion.h"
#include "host/scene/scene_checks.h"
#include "kernels/math/quat.h"

namespace scree {
namespace {

constexpr double kUnitTolerance = 1e-6;  // deviation from length one that is taken for rounding

// Written so that NaN fails.
bool is_unit(double length) { return std::abs(length - 1) <= kUnitTolerance; }

std::optional<Fault> samples_fault(const Motion& motion) {
  const std::size_t count = motion.times.size();
  if (count < 2)
    return Fault{"motion.times", fmt::format("{} times", count), "must be two times or more [s]"};
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(motion.times[i]) || (i > 0 && motion.times[i] <= motion.times[i - 1]))
      return Fault{fmt::format("motion.times[{}]", i), value_text(motion.times[i]),
                   "must be finite and larger than the time before [s]"};
  }
  if (motion.positions.size() != count)
    return Fault{"motion.positions", fmt::format("{} positions", motion.positions.size()),
                 fmt::format("must be one per time, {}", count)};
  for (std::size_t i = 0; i < count; ++i)
    if (!is_finite(motion.positions[i]))
      return Fault{fmt::format("motion.positions[{}]", i), value_text(motion.positions[i]),
                   "must be three finite numbers [m]"};
  if (!motion.orientations.empty() && motion.orientations.size() != count)
    return Fault{"motion.orientations", fmt::format("{} orientations", motion.orientations.size()),
                 fmt::format("must be none or one per time, {}", count)};
  for (std::size_t i = 0; i < motion.orientations.size(); ++i)
    if (auto fault = turn_fault(fmt::format("motion.orientations[{}]", i), motion.orientations[i]))
      return fault;
  return std::nullopt;
}

/// A pose at the end of a step does not tell how many times a body has turned round in it.
std::optional<Fault> turn_rate_fault(const Motion& motion, double time_step) {
  const MostTurn most = most_turn(motion, time_step);
  if (most.turn < std::numbers::pi) return std::nullopt;
  return Fault{most.field, most.value,
               fmt::format("must turn the body by less than half a turn in a time step of {} s{}",
                           time_step, motion.kind == Motion::Kind::sampled ? "" : " [rad/s]")};
}

}  // namespace

std::optional<Fault> turn_fault(const std::string& field, const Quatd& q) {
  if (is_unit(std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z))) return std::nullopt;
  return Fault{field, fmt::format("[{}, {}, {}, {}]", q.w, q.x, q.y, q.z),
               "must be a unit quaternion [w, x, y, z]"};
}

std::optional<Fault> motion_fault(const BodyDescription& body, double time_step) {
  const Motion& motion = body.motion;
  if (motion.kind == Motion::Kind::none) return std::nullopt;
  if (body.kind != BodyKind::kinematic)
    return Fault{"motion", "a motion", "only kinematic bodies have one"};
  if (!std::isfinite(motion.start))
    return Fault{"motion.start", value_text(motion.start), "must be a finite number [s]"};
  if (!(motion.stop >= motion.start))
    return Fault{"motion.stop", value_text(motion.stop), "must not be before motion.start [s]"};
  const bool turning = motion.kind == Motion::Kind::rotating;
  const bool swinging = motion.kind == Motion::Kind::oscillating;
  if ((turning || swinging) && !is_unit(norm(motion.axis)))
    return Fault{"motion.axis", value_text(motion.axis), "must have length 1"};
  if (motion.kind == Motion::Kind::linear && !is_finite(motion.velocity))
    return Fault{"motion.velocity", value_text(motion.velocity),
                 "must be three finite numbers [m/s]"};
  if (motion.kind == Motion::Kind::linear && !is_finite(motion.angular_velocity))
    return Fault{"motion.angular_velocity", value_text(motion.angular_velocity),
                 "must be three finite numbers [rad/s]"};
  if (turning && !is_finite(motion.center))
    return Fault{"motion.center", value_text(motion.center), "must be three finite numbers [m]"};
  if (turning && !std::isfinite(motion.rate))
    return Fault{"motion.rate", value_text(motion.rate), "must be a finite number [rad/s]"};
  if (swinging && !std::isfinite(motion.amplitude))
    return Fault{"motion.amplitude", value_text(motion.amplitude), "must be a finite number [m]"};
  if (swinging && !(std::isfinite(motion.frequency) && motion.frequency >= 0))
    return Fault{"motion.frequency", value_text(motion.frequency), "must be zero or positive [Hz]"};
  if (swinging && !std::isfinite(motion.phase))
    return Fault{"motion.phase", value_text(motion.phase), "must be a finite number [rad]"};
  if (motion.kind == Motion::Kind::sampled)
    if (auto fault = samples_fault(motion)) return fault;
  return turn_rate_fault(motion, time_step);
}

}  // namespace scree
