#include "host/scene/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {
namespace {

/// Rotation vector of a unit quaternion, angle in [0, pi].
Vec3d log_map(Quatd q) {
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const double s = norm(q.vec());
  const double angle = 2 * std::atan2(s, q.w);
  return s > 0 ? (angle / s) * q.vec() : Vec3d{};
}

Pose sampled_pose(const Motion& m, const BodyDescription& body, double t) {
  const auto next = std::upper_bound(m.times.begin(), m.times.end(), t);
  std::size_t k = static_cast<std::size_t>(next - m.times.begin());
  // Before the first and after the last sample the body rests at it.
  const std::size_t last = m.times.size() - 1;
  const std::size_t i = k == 0 ? 0 : k - 1;
  const std::size_t j = std::min(k, last);
  const double span = m.times[j] - m.times[i];
  const double s = span > 0 ? std::clamp((t - m.times[i]) / span, 0.0, 1.0) : 0.0;
  Pose pose{body.position, body.orientation};
  pose.position += (1 - s) * m.positions[i] + s * m.positions[j];
  if (!m.orientations.empty()) {
    const Quatd a = m.orientations[i];
    const Quatd turn = exp_map(s * log_map(m.orientations[j] * conjugate(a))) * a;
    pose.orientation = normalized(turn * body.orientation);
  }
  return pose;
}

}  // namespace

Pose pose_at(const BodyDescription& body, double t) {
  const Motion& m = body.motion;
  // Time the motion has been running; it holds its place before `start` and after `stop`.
  const double running = std::clamp(t, m.start, std::max(m.start, m.stop)) - m.start;
  Pose pose{body.position, body.orientation};
  switch (m.kind) {
    case Motion::Kind::none:
      break;
    case Motion::Kind::linear:
      pose.position += running * m.velocity;
      if (norm2(m.angular_velocity) > 0)
        pose.orientation = normalized(exp_map(running * m.angular_velocity) * body.orientation);
      break;
    case Motion::Kind::rotating: {
      const Quatd turn = exp_map(running * m.rate * m.axis);
      pose.position = m.center + rotate(turn, body.position - m.center);
      pose.orientation = normalized(turn * body.orientation);
      break;
    }
    case Motion::Kind::oscillating: {
      const double omega = 2 * std::numbers::pi * m.frequency;
      pose.position +=
          m.amplitude * (std::sin(omega * running + m.phase) - std::sin(m.phase)) * m.axis;
      break;
    }
    case Motion::Kind::sampled:
      return sampled_pose(m, body, running + m.start);
  }
  return pose;
}

Rates rates_between(const Pose& from, const Pose& to, double h) {
  return {(1 / h) * (to.position - from.position),
          (1 / h) * log_map(to.orientation * conjugate(from.orientation))};
}

bool rotates(const BodyDescription& body) {
  if (body.kind != BodyKind::kinematic) return false;
  return turns(body.motion);
}

bool turns(const Motion& motion) {
  switch (motion.kind) {
    case Motion::Kind::rotating:
      return true;
    case Motion::Kind::linear:
      return norm2(motion.angular_velocity) > 0;
    case Motion::Kind::sampled:
      return !motion.orientations.empty();
    default:
      return false;
  }
}

bool keeps_direction(const BodyDescription& body, const Vec3d& direction) {
  constexpr double kRounding = 1e-12;
  if (!rotates(body)) return true;
  const Motion& m = body.motion;
  const auto is_along = [&](const Vec3d& axis) {
    return norm(cross(axis, direction)) <= kRounding * norm(axis);
  };
  if (m.kind == Motion::Kind::linear) return is_along(m.angular_velocity);
  if (m.kind == Motion::Kind::rotating) return m.rate == 0 || is_along(m.axis);
  return std::all_of(m.orientations.begin(), m.orientations.end(), [&](const Quatd& q) {
    return norm(rotate(q, direction) - direction) <= kRounding;
  });
}

}  // namespace scree
