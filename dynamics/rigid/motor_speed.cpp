#include "dynamics/rigid/motor_speed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/scene/scene_summary.h"

namespace scree {
namespace {

/// The least mass and radius of the free bodies of a joint [kg, m].
struct Lightest {
  double mass = std::numeric_limits<double>::infinity();
  double radius = std::numeric_limits<double>::infinity();
};
Lightest lightest(const Scene& scene, const JointFrames& joint) {
  Lightest out;
  for (const Index id : joint.body) {
    if (id == kWorldId) continue;
    const BodyDescription& body = scene.bodies[static_cast<std::size_t>(id)];
    if (body.kind != BodyKind::free) continue;
    out.mass = std::min(out.mass, body.mass);
    out.radius = std::min(out.radius, bounding_radius(scene, body));
  }
  return out;
}

/// Speed that a motor gives in the first step [m/s]; zero: it does not count.
double speed_of(const JointDrive& drive, double mass, double length, double time_step) {
  const double unit = time_step / (mass * length),
               bound = unit * (std::abs(drive.force) + drive.most);
  if (!(drive.stiffness > 0 || drive.damping > 0)) return std::isfinite(bound) ? bound : 0;
  // As its row does it, with the velocity at the end of the step: else stiff ones would count for more than they give.
  const double pull = unit * (std::abs(drive.force) + drive.stiffness * std::abs(drive.target));
  const double resistance = unit / length * (time_step * drive.stiffness + drive.damping);
  return std::min(pull / (1 + resistance), bound);
}

}  // namespace

double motor_speed(const Scene& scene, const std::vector<JointFrames>& frames) {
  double squares = 0;
  for (const JointFrames& joint : frames) {
    const JointDrive& drive = joint.drive;
    const bool is_held = (joint.held >> kJointAxisRow & 1u) != 0;
    if (is_held || joint.form == JointForm::line) continue;
    const Lightest body = lightest(scene, joint);
    const double length = ends_with_force(joint.form) ? 1 : body.radius;
    const double speed = speed_of(drive, body.mass, length, scene.stepping.time_step);
    if (std::isfinite(speed)) squares += speed * speed;
  }
  if (!(squares > 0)) return 0;
  const auto free = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                  [](const auto& b) { return b.kind == BodyKind::free; });
  return std::sqrt(squares / static_cast<double>(std::max<std::ptrdiff_t>(free, 1)));
}

}  // namespace scree
