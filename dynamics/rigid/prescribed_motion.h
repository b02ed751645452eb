#pragma once
// Kinematic bodies: poses and velocities as their scene prescribes them.

#include "dynamics/rigid/body_store.h"
#include "host/scene/motion.h"
#include "kernels/bodies/range.h"

namespace scree {

class PrescribedMotion {
 public:
  /// Keeps the descriptions of fixed and kinematic bodies.
  explicit PrescribedMotion(const Scene& scene) : time_step_(scene.stepping.time_step) {
    for (const BodyDescription& body : scene.bodies) {
      if (body.kind == BodyKind::free) continue;
      walls_.push_back(body);
      has_motion_ = has_motion_ || body.kind == BodyKind::kinematic;
    }
  }

  /// Puts kinematic bodies at their pose of time t with the velocity of the step that starts there.
  /// @param step  number of that step, for messages
  template <class B, class Real>
  void set(BodyStore<B, Real>& store, double t, std::int64_t step) const {
    if (!has_motion_) return;
    const double h = time_step_;
    std::vector<Vec3d> position;
    std::vector<Quat<Real>> orientation;
    std::vector<Vec3<Real>> velocity, angular_velocity;
    for (const BodyDescription& wall : walls_) {
      const Pose now = pose_at(wall, t);
      const Rates rates = rates_between(now, pose_at(wall, t + h), h);
      if (!is_in_range(now.position) || !is_speed_in_range(norm(rates.velocity), h)) {
        const auto place = store.fixed_begin() + static_cast<Index>(position.size());
        throw_bad_body(step, store.id_of(place), now.position, rates.velocity);
      }
      position.push_back(now.position);
      orientation.emplace_back(now.orientation);
      velocity.emplace_back(rates.velocity);
      angular_velocity.emplace_back(rates.angular_velocity);
    }
    store.set_fixed_motion(position, orientation, velocity, angular_velocity);
  }

 private:
  double time_step_;                    ///< [s]
  std::vector<BodyDescription> walls_;  ///< fixed and kinematic bodies, in storage order
  bool has_motion_ = false;
};

}  // namespace scree
