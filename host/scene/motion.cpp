#include "host/scene/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/scene/scene_checks.h"

namespace scree {
namespace {

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

/// The most of samples, which between two of them turn the shorter way: at the end of a time that begins with a sample, or ends
/// with one.
MostTurn most_turn_of_samples(const Motion& motion, double time) {
  const std::vector<double>& times = motion.times;
  std::vector<double> turned{0};  // from the first sample on [rad]
  for (std::size_t i = 1; i < motion.orientations.size(); ++i) {
    const Quatd &a = motion.orientations[i - 1], &b = motion.orientations[i];
    const double same = std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
    turned.push_back(turned.back() + 2 * std::acos(std::min(1.0, same)));
  }
  if (motion.orientations.empty()) return {};
  const auto turned_at = [&](double t) {
    const auto after = std::upper_bound(times.begin(), times.end(), t);
    if (after == times.begin()) return 0.0;
    if (after == times.end()) return turned.back();
    const auto i = static_cast<std::size_t>(after - times.begin());
    const double share = (t - times[i - 1]) / (times[i] - times[i - 1]);
    return turned[i - 1] + share * (turned[i] - turned[i - 1]);
  };
  MostTurn most;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double here =
        std::max(turned_at(times[i] + time) - turned[i], turned[i] - turned_at(times[i] - time));
    if (!(here > most.turn)) continue;
    most.turn = here;
    most.field = fmt::format("motion.orientations[{}]", i);
  }
  most.value = fmt::format("{:.4g} rad within a time step", most.turn);
  return most;
}

}  // namespace

MostTurn most_turn(const Motion& motion, double time) {
  switch (motion.kind) {
    case Motion::Kind::rotating:
      return {std::abs(motion.rate) * time, "motion.rate", value_text(motion.rate)};
    case Motion::Kind::linear:
      return {norm(motion.angular_velocity) * time, "motion.angular_velocity",
              value_text(motion.angular_velocity)};
    case Motion::Kind::sampled:
      return most_turn_of_samples(motion, time);
    default:
      return {};
  }
}

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
