#pragma once
// Scenes of the model of affine bodies.

#include <cmath>

#include "tests/physics/scene_builder.h"

namespace scree::test {

/// No bodies; friction between all that come.
inline Scene affine_scene(double time_step, double friction, double rule = 0) {
  Scene scene = physics::empty_scene(time_step, friction);
  scene.dynamics.type = "affine";
  scene.dynamics.parameters = {{"rule", rule}};
  return scene;
}

using physics::cpu_options;

/// Places in StepReport::own of the model, see affine_card.h.
enum AffineColumn : std::size_t {
  min_gap,
  max_strain,
  barrier_stiffness,
  blocked,
  momentum_x,
  momentum_y,
  momentum_z
};

/// Boxes that fall on a floor and on each other, turned and spinning.
inline Scene falling_boxes(double rule) {
  Scene scene = affine_scene(0.01, 0.3, rule);
  scene.dynamics.parameters["barrier_stiffness"] = 1e12;
  scene.dynamics.parameters["reach"] = 2e-3;
  scene.dynamics.parameters["tolerance"] = 1e-9;
  physics::add_wall_box(scene, {0, 0, -0.1}, {1, 1, 0.1});
  for (int k = 0; k < 4; ++k) {
    BodyDescription& box =
        physics::add_box(scene, {0.03 * k, 0.02 * k, 0.12 + 0.25 * k}, {0.1, 0.08, 0.06}, 4);
    box.orientation = exp_map(Vec3d{0.3 * k, 0.2, 0.1 * k});
    box.angular_velocity = {1, 0.5 * k, -1};
  }
  return scene;
}

/// A prescribed box that goes straight on.
inline void add_pusher(Scene& scene, const Vec3d& position, const Vec3d& half,
                       const Vec3d& velocity) {
  Motion motion;
  motion.kind = Motion::Kind::linear;
  motion.velocity = velocity;
  physics::add_wall_box(scene, position, half, BodyKind::kinematic).motion = motion;
}

/// Two bodies on hinges with a motor that turns the first one several times, friction and limits.
inline Scene driven_pair() {
  Scene scene = affine_scene(0.002, 0, 1);
  scene.dynamics.parameters["tolerance"] = 1e-9;
  physics::add_box(scene, {0, 0, 0}, {0.2, 0.05, 0.2}, 3);
  physics::add_box(scene, {0.15, 0.2, 0}, {0.3, 0.03, 0.04}, 1);
  Joint axle, arm;
  axle.bodies = {kWorldBody, 0};
  axle.axis = {0, 1, 0};
  axle.motor = JointMotor{.position = 20, .stiffness = 2, .damping = 0.1, .max_force = 5};
  arm.bodies = {0, 1};
  arm.anchor = {0.15, 0.1, 0};
  arm.axis = {0, 1, 0};
  arm.friction = 0.05;
  arm.limits = {-0.5, 0.7};
  scene.joints = {axle, arm};
  return scene;
}

}  // namespace scree::test
