#pragma once
// Scenes of joints whose drives change little in a step, with the settings that a scene has by default.

#include "tests/physics/joint_scenes.h"

namespace scree::physics {

inline constexpr double kWeakStep = 1e-3;

inline Scene default_scene() {
  Scene scene = empty_scene(kWeakStep, 0.5);
  scene.solver = SolverSettings{};
  return scene;
}

/// A wheel that a motor of 1 N m turns. @param moment  of the wheel, out
inline Scene weak_motor(double& moment) {
  Scene scene = default_scene();
  moment = add_box(scene, {}, {0.5, 0.5, 0.05}, 100).inertia.z;
  Joint axle = joint_of(JointKind::hinge, kWorldBody, 0, {});
  axle.motor = JointMotor{.speed = 10, .max_force = 1};
  scene.joints = {axle};
  return scene;
}

constexpr double kPress = 50;

/// A plate of 2 kg, 1, 5 cm above a fixed one that a motor presses it on with 50 N, without gravity.
inline Scene press(const JointMotor& motor) {
  Scene scene = default_scene();
  scene.gravity = {};
  add_wall_box(scene, {0, 0, -0.5}, {1, 1, 0.1});
  add_box(scene, {0, 0, -0.3}, {0.5, 0.5, 0.05}, 2);
  Joint slider = joint_of(JointKind::slider, kWorldBody, 1, {});
  slider.motor = motor;
  scene.joints = {slider};
  return scene;
}

/// A lever on a hinge, 1, that a motor presses on a block at 0.5 m of it with 50 N m, without gravity. It begins 0.01 rad above it.
inline Scene lever_on_a_block(const JointMotor& motor = {.speed = 1, .max_force = kPress}) {
  Scene scene = default_scene();
  scene.gravity = {};
  add_wall_box(scene, {0.5, 0, -0.12}, {0.02, 0.1, 0.1});
  add_box(scene, {0.4, 0, 0}, {0.4, 0.05, 0.015}, 3);
  Joint hinge = joint_of(JointKind::hinge, kWorldBody, 1, {}, {0, 1, 0});
  hinge.motor = motor;
  scene.joints = {hinge};
  return scene;
}

/// A body that friction stops after 2.25 m.
inline Scene braked_slider() {
  Scene scene = default_scene();
  scene.gravity = {};
  add_sphere(scene, {}, 0.1, 2).velocity = {3, 0, 0};
  Joint slider = joint_of(JointKind::slider, kWorldBody, 0, {}, {1, 0, 0});
  slider.friction = 4;
  scene.joints = {slider};
  return scene;
}

/// Two links whose motors bring them to 0.3 and -0.4 rad: two drives on one body.
inline Scene arm_of_two_soft_motors() {
  Scene scene = default_scene();
  scene.gravity = {};
  add_box(scene, {0.5, 0, 0}, {0.5, 0.1, 0.1}, 50);
  add_box(scene, {1.5, 0, 0}, {0.5, 0.1, 0.1}, 50);
  Joint shoulder = joint_of(JointKind::hinge, kWorldBody, 0, {});
  Joint elbow = joint_of(JointKind::hinge, 0, 1, {1, 0, 0});
  shoulder.motor = JointMotor{.position = 0.3, .stiffness = 60, .damping = 120};
  elbow.motor = JointMotor{.position = -0.4, .stiffness = 30, .damping = 40};
  scene.joints = {shoulder, elbow};
  return scene;
}

/// Body 1 swings on a spring by 2 cm; those that rest beside it make the residual of all small.
inline Scene spring_beside_bodies_at_rest() {
  Scene scene = default_scene();
  add_plane(scene);
  add_box(scene, {0, 0, 1}, {0.05, 0.05, 0.05}, 1);
  for (int i = 0; i < 200; ++i)
    add_box(scene, {0.1 * (i % 20), 1 + 0.1 * (i / 20), 0.025}, {0.025, 0.025, 0.025}, 0.125);
  Joint guide = joint_of(JointKind::slider, kWorldBody, 1, {0, 0, 1}, {1, 0, 0});
  Joint spring = line_of(JointKind::spring, kWorldBody, 1, {-1, 0, 1}, {0, 0, 1});
  spring.stiffness = 100;
  spring.length = 0.98;
  scene.joints = {guide, spring};
  return scene;
}

inline void run_for(World& world, double seconds) {
  for (int k = static_cast<int>(std::lround(seconds / kWeakStep)); k > 0; --k) world.step();
}

/// Farthest that the body on the spring is from where it should be, in two periods [m].
inline double error_of_swing(World& world) {
  double worst = 0;
  for (int k = 1; k <= 1257; ++k) {
    world.step();
    const double expected = -0.02 + 0.02 * std::cos(10 * k * kWeakStep);
    worst = std::max(worst, std::abs(world.states().position[1].x - expected));
  }
  return worst;
}

}  // namespace scree::physics
