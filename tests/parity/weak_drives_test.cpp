// Joints whose drives change little in a step, in default solves on a GPU: closed forms, as on the CPU.

#include <algorithm>
#include <cmath>

#include "tests/parity/parity.h"
#include "tests/physics/joint_scenes.h"

namespace scree::parity {
namespace {

using physics::joint_of;
using physics::line_of;

class ParityWeakDrives : public Parity {};

Scene default_scene() {
  Scene scene = physics::empty_scene(1e-3, 0.5);
  scene.solver = SolverSettings{};
  return scene;
}

TEST_F(ParityWeakDrives, AMotorTurnsAHeavyWheelAndFrictionStopsABody) {
  for (const Precision precision : kPrecisions) {
    SCOPED_TRACE(name_of(precision));
    Scene scene = default_scene();
    const double moment = physics::add_box(scene, {}, {0.5, 0.5, 0.05}, 100).inertia.z;
    Joint axle = joint_of(JointKind::hinge, kWorldBody, 0, {});
    axle.motor = JointMotor{.speed = 10, .max_force = 1};
    physics::add_sphere(scene, {0, 5, 0}, 0.1, 2).velocity = {3, 0, 0};
    Joint slider = joint_of(JointKind::slider, kWorldBody, 1, {0, 5, 0}, {1, 0, 0});
    slider.friction = 4;
    scene.joints = {axle, slider};
    World world = world_on(BackendKind::cuda, scene, precision);
    for (int k = 0; k < 2000; ++k) world.step();
    const BodyStates s = world.states();
    EXPECT_NEAR(s.angular_velocity[0].z, 2 / moment, 0.02 / moment);
    EXPECT_NEAR(s.position[1].x, 2.25, 0.01);
    EXPECT_NEAR(s.velocity[1].x, 0, 1e-3);
  }
}

/// Two drives on one body: several steps among them.
TEST_F(ParityWeakDrives, AnArmOfTwoSoftMotorsComesToItsPlace) {
  Scene scene = default_scene();
  scene.gravity = {};
  physics::add_box(scene, {0.5, 0, 0}, {0.5, 0.1, 0.1}, 50);
  physics::add_box(scene, {1.5, 0, 0}, {0.5, 0.1, 0.1}, 50);
  Joint shoulder = joint_of(JointKind::hinge, kWorldBody, 0, {});
  Joint elbow = joint_of(JointKind::hinge, 0, 1, {1, 0, 0});
  shoulder.motor = JointMotor{.position = 0.3, .stiffness = 60, .damping = 120};
  elbow.motor = JointMotor{.position = -0.4, .stiffness = 30, .damping = 40};
  scene.joints = {shoulder, elbow};
  World world = world_on(BackendKind::cuda, scene);
  for (int k = 0; k < 15000; ++k) world.step();
  const std::vector<JointRecord> joints = world.joints();
  EXPECT_NEAR(joints[0].position, 0.3, 0.02);
  EXPECT_NEAR(joints[1].position, -0.4, 0.02);
}

TEST_F(ParityWeakDrives, ASpringSwingsBesideManyBodiesAtRest) {
  Scene scene = default_scene();
  physics::add_plane(scene);
  physics::add_box(scene, {0, 0, 1}, {0.05, 0.05, 0.05}, 1);
  for (int i = 0; i < 200; ++i)
    physics::add_box(scene, {0.1 * (i % 20), 1 + 0.1 * (i / 20), 0.025}, {0.025, 0.025, 0.025},
                     0.125);
  Joint guide = joint_of(JointKind::slider, kWorldBody, 1, {0, 0, 1}, {1, 0, 0});
  Joint spring = line_of(JointKind::spring, kWorldBody, 1, {-1, 0, 1}, {0, 0, 1});
  spring.stiffness = 100;
  spring.length = 0.98;
  scene.joints = {guide, spring};
  World world = world_on(BackendKind::cuda, scene);
  double worst = 0;
  for (int k = 1; k <= 1257; ++k) {
    world.step();
    const double expected = -0.02 + 0.02 * std::cos(10 * k * 1e-3);
    worst = std::max(worst, std::abs(world.states().position[1].x - expected));
  }
  EXPECT_LT(worst, 0.02 * 0.05);
}

}  // namespace
}  // namespace scree::parity
