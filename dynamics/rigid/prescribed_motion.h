#pragma once
// Kinematic bodies: poses and velocities as their scene, or a program that runs it, prescribes them.

#include <map>

#include "dynamics/rigid/body_store.h"
#include "host/scene/motion.h"
#include "kernels/bodies/range.h"

namespace scree {

class PrescribedMotion {
 public:
  /// Keeps the descriptions of fixed and kinematic bodies.
  explicit PrescribedMotion(const Scene& scene);

  /// Puts kinematic bodies at their pose of time t with the velocity of the step that starts there.
  /// @param step  number of that step, for messages
  template <class B, class Real>
  void set(BodyStore<B, Real>& store, double t, std::int64_t step) const {
    if (!has_motion_) return;
    const double h = time_step_;
    std::vector<Vec3d> position;
    std::vector<Quat<Real>> orientation;
    std::vector<Vec3<Real>> velocity, angular_velocity;
    for (const Wall& wall : walls_) {
      const auto own = replaced_.find(wall.id);
      const Course& course = own == replaced_.end() ? wall.course : own->second;
      const Pose now = course.at(t);
      const Rates rates = rates_between(now, course.at(t + h), h);
      if (!is_in_range(now.position) || !is_speed_in_range(norm(rates.velocity), h))
        throw_bad_body(step, wall.id, now.position, rates.velocity);
      position.push_back(now.position);
      orientation.emplace_back(now.orientation);
      velocity.emplace_back(rates.velocity);
      angular_velocity.emplace_back(rates.angular_velocity);
    }
    store.set_fixed_motion(position, orientation, velocity, angular_velocity);
  }

  /// Gives a kinematic body another motion, whose times count from `now` and which begins where the body is then.
  /// @param scene     the lists that bodies point into
  /// @param may_turn  whether contacts of this run have arms
  /// @throws InputError when the body has no motion, or cannot have this one
  void replace(const Scene& scene, int body, const Motion& motion, double now, bool may_turn);

  /// The motions that replace() gave, for checkpoints.
  void save(WorldState& s) const;
  /// @throws InputError when they are not motions of kinematic bodies of the scene
  void restore(const Scene& scene, const WorldState& s, bool may_turn);

 private:
  /// How a body goes on from a time on.
  struct Course {
    BodyDescription body;
    double since = 0;  ///< time at which the times of its motion begin [s]
    Pose at(double t) const { return pose_at(body, t - since); }
  };
  /// A fixed or kinematic body.
  struct Wall {
    int id = 0;
    Course course;  ///< of the scene
  };
  const Wall& kinematic(int body) const;

  double time_step_;                ///< [s]
  std::vector<Wall> walls_;         ///< in storage order, ids rising
  std::map<int, Course> replaced_;  ///< by id, those that programs set
  bool has_motion_ = false;
};

}  // namespace scree
