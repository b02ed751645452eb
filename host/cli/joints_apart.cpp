#include "host/cli/joints_apart.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/scene/body_name.h"
#include "host/scene/joint_cards.h"

namespace scree {

namespace {

/// Radius of the smallest free body [m].
double smallest_radius(const BodyConstants& bodies) {
  constexpr std::size_t kMostBodies = 1 << 20;  // that are looked at for it
  double smallest = 0;
  for (std::size_t id = 0; id < std::min(bodies.size(), kMostBodies); ++id) {
    const BodyConstant body = bodies[id];
    const bool counts = body.kind == BodyKind::free && body.radius > 0;
    if (counts && (smallest == 0 || body.radius < smallest)) smallest = body.radius;
  }
  return smallest;
}

}  // namespace

bool are_joints_apart(double error, const BodyConstants& bodies) {
  constexpr double kApart = 0.02;  // of the smallest body
  return error > 0 && error > kApart * smallest_radius(bodies);
}

bool are_joints_contradicted(const StepReport& report, double time_step,
                             const BodyConstants& bodies) {
  constexpr double kApart = 1e-6;  // of the smallest body, in a step
  if (report.converged || report.residual_max_joint < 0) return false;
  if (report.residual_relative > 0 && report.residual_relative <= 1) return false;
  return time_step * report.residual_rms > kApart * smallest_radius(bodies);
}

std::string joint_with_number(int number, const std::vector<Joint>& joints,
                              const BodyConstants& bodies) {
  const Joint& joint = joints.at(static_cast<std::size_t>(number));
  return fmt::format("joints[{}] ({}) of {} and {}", number, joint_card(joint.kind).name,
                     body_with_id(bodies, joint.bodies[0]), body_with_id(bodies, joint.bodies[1]));
}

std::string joints_apart(const RunTotals& t, const std::vector<Joint>& joints,
                         const BodyConstants& bodies) {
  if (!are_joints_apart(t.max_joint_error(), bodies)) return {};
  std::string text = fmt::format(
      "joints were off by up to {:.3g} m, in step {} (max_joint_error_m): they contradict each "
      "other or a motion, began apart, are so nearly in a line that they cannot hold, or carry "
      "more "
      "than a step of this length can follow",
      t.max_joint_error(), t.joint_error_step());
  if (t.joint_error_joint() < 0) return text;  // models may not know
  return text + "; farthest off was " + joint_with_number(t.joint_error_joint(), joints, bodies);
}

}  // namespace scree
