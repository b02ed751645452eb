#include "dynamics/rigid/motor_speed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/scene/scene_summary.h"

namespace scree {

double motor_speed(const Scene& scene, const std::vector<JointFrames>& frames) {
  double squares = 0;
  for (const JointFrames& joint : frames) {
    const JointDrive& drive = joint.drive;
    const bool is_held = (joint.held >> kJointAxisRow & 1u) != 0;
    if (is_held || drive.stiffness > 0 || drive.damping > 0) continue;
    const double force = std::abs(drive.force) + drive.most;
    if (!(force > 0 && std::isfinite(force))) continue;
    double mass = std::numeric_limits<double>::infinity(), radius = mass;
    for (const Index id : joint.body) {
      if (id == kWorldId) continue;
      const BodyDescription& body = scene.bodies[static_cast<std::size_t>(id)];
      if (body.kind != BodyKind::free) continue;
      mass = std::min(mass, body.mass);
      radius = std::min(radius, bounding_radius(scene, body));
    }
    const double length = ends_with_force(joint.form) ? 1 : radius;
    const double speed = scene.stepping.time_step * force / (mass * length);
    if (std::isfinite(speed)) squares += speed * speed;
  }
  if (!(squares > 0)) return 0;
  const auto free = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                  [](const auto& b) { return b.kind == BodyKind::free; });
  return std::sqrt(squares / static_cast<double>(std::max<std::ptrdiff_t>(free, 1)));
}

}  // namespace scree
