// Joints whose drives change little in a step, solved to `quality` as scenes are by default: what is left out of one step must
// not be left out of all.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kStep = 1e-3;

Scene default_scene() {
  Scene scene = empty_scene(kStep, 0.5);
  scene.precision = "float";
  scene.solver = SolverSettings{};
  return scene;
}

class WeakDrives : public testing::TestWithParam<std::string> {
 protected:
  World world_of(Scene scene) const {
    scene.solver.name = GetParam();
    return World(scene, cpu_options(1, Precision::single_precision));
  }
};
INSTANTIATE_TEST_SUITE_P(Solvers, WeakDrives, testing::ValuesIn(kJointSolvers));

void run(World& world, double seconds) {
  for (int k = static_cast<int>(std::lround(seconds / kStep)); k > 0; --k) world.step();
}

TEST_P(WeakDrives, AWeakMotorTurnsAHeavyWheel) {
  for (const bool is_warm : {true, false}) {
    Scene scene = default_scene();
    const double moment = add_box(scene, {}, {0.5, 0.5, 0.05}, 100).inertia.z;
    Joint axle = joint_of(JointKind::hinge, kWorldBody, 0, {});
    axle.motor = JointMotor{.speed = 10, .max_force = 1};
    scene.joints = {axle};
    scene.solver.warm_start = is_warm;
    World world = world_of(scene);
    run(world, 2);
    EXPECT_NEAR(world.states().angular_velocity[0].z, 2 / moment, 0.02 / moment);
  }
}

TEST_P(WeakDrives, FrictionStopsABodyThatNothingElseHolds) {
  Scene scene = default_scene();
  scene.gravity = {};
  add_sphere(scene, {}, 0.1, 2).velocity = {3, 0, 0};
  Joint slider = joint_of(JointKind::slider, kWorldBody, 0, {}, {1, 0, 0});
  slider.friction = 4;
  scene.joints = {slider};
  World world = world_of(scene);
  run(world, 2);
  EXPECT_NEAR(world.states().position[0].x, 2.25, 0.01);
  EXPECT_NEAR(world.states().velocity[0].x, 0, 1e-3);
}

TEST_P(WeakDrives, FrictionInAHingeDampsAPendulum) {
  Scene scene = default_scene();
  add_sphere(scene, {std::sin(0.5), 0, -std::cos(0.5)}, 0.1, 1);
  Joint hinge = joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0});
  hinge.friction = 0.3;
  scene.joints = {hinge};
  World world = world_of(scene);
  double highest = 0;  // of the swing back
  for (int k = 0; k < 2800; ++k) {
    world.step();
    const double x = world.states().position[0].x;
    if (k > 1400) highest = std::max(highest, x);
  }
  // m g l (cos b - cos a) is the work of friction, 0.3 (a + b), on the way there, and again back.
  const auto next = [](double from) {
    double low = 0, high = from;
    for (int k = 0; k < 60; ++k) {
      const double to = 0.5 * (low + high);
      (kGravity * (std::cos(to) - std::cos(from)) > 0.3 * (from + to) ? low : high) = to;
    }
    return low;
  };
  EXPECT_NEAR(std::asin(highest), next(next(0.5)), 0.01);
}

/// Several motors and springs on one body, and a driven body on another: two links with soft drives.
TEST_P(WeakDrives, AnArmOfTwoSoftMotorsComesToItsPlace) {
  Scene scene = default_scene();
  scene.gravity = {};
  add_box(scene, {0.5, 0, 0}, {0.5, 0.1, 0.1}, 50);
  add_box(scene, {1.5, 0, 0}, {0.5, 0.1, 0.1}, 50);
  Joint shoulder = joint_of(JointKind::hinge, kWorldBody, 0, {});
  Joint elbow = joint_of(JointKind::hinge, 0, 1, {1, 0, 0});
  shoulder.motor = JointMotor{.position = 0.3, .stiffness = 60, .damping = 120};
  elbow.motor = JointMotor{.position = -0.4, .stiffness = 30, .damping = 40};
  scene.joints = {shoulder, elbow};
  World world = world_of(scene);
  run(world, 25);
  const std::vector<JointRecord> joints = world.joints();
  EXPECT_NEAR(joints[0].position, 0.3, 0.01);
  EXPECT_NEAR(joints[1].position, -0.4, 0.01);
}

/// Those that rest beside it make the residual of all small.
TEST_P(WeakDrives, ASpringSwingsBesideManyBodiesAtRest) {
  if (GetParam() == "jacobi") GTEST_SKIP() << "two hundred boxes take it long";
  Scene scene = default_scene();
  scene.gravity = {0, 0, -kGravity};
  add_plane(scene);
  add_box(scene, {0, 0, 1}, {0.05, 0.05, 0.05}, 1);
  for (int i = 0; i < 200; ++i)
    add_box(scene, {0.1 * (i % 20), 1 + 0.1 * (i / 20), 0.025}, {0.025, 0.025, 0.025}, 0.125);
  Joint guide = joint_of(JointKind::slider, kWorldBody, 1, {0, 0, 1}, {1, 0, 0});
  Joint spring = line_of(JointKind::spring, kWorldBody, 1, {-1, 0, 1}, {0, 0, 1});
  spring.stiffness = 100;
  spring.length = 0.98;
  scene.joints = {guide, spring};
  World world = world_of(scene);
  double worst = 0;
  for (int k = 1; k <= 1257; ++k) {  // two periods
    world.step();
    const double expected = -0.02 + 0.02 * std::cos(10 * k * kStep);
    worst = std::max(worst, std::abs(world.states().position[1].x - expected));
  }
  EXPECT_LT(worst, 0.02 * 0.05);
}

/// Locked axes that keep a body in a plane, as its hinge does: rows of the hinge which they hold already have no block of their own.
TEST_P(WeakDrives, AHingeAgreesWithLockedAxes) {
  double free_x = 0, free_z = 0;
  for (const int locks : {0, int{lock_rz}, lock_rx | lock_rz, lock_y | lock_rx | lock_rz}) {
    Scene scene = default_scene();
    scene.gravity = {0, 0, -kGravity};
    add_box(scene, {0.5, 0, 0}, {0.1, 0.05, 0.15}, 2).locks = static_cast<std::uint8_t>(locks);
    scene.joints = {joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0})};
    World world = world_of(scene);
    run(world, 0.5);
    const Vec3d x = world.states().position[0];
    if (locks == 0) {
      free_x = x.x, free_z = x.z;
      EXPECT_LT(free_z, -0.3);
    }
    EXPECT_NEAR(x.x, free_x, 2e-3) << "locks " << locks;
    EXPECT_NEAR(x.z, free_z, 2e-3) << "locks " << locks;
  }
}

}  // namespace
}  // namespace scree::physics
