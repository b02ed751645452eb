// Joints whose drives change little in a step, solved to `quality` as scenes are by default: what is left out of one step must
// not be left out of all.

#include "tests/physics/weak_drives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree::physics {
namespace {

class WeakDrives : public testing::TestWithParam<std::string> {
 protected:
  World world_of(Scene scene) const {
    scene.solver.name = GetParam();
    return World(scene, cpu_options(1, Precision::single_precision));
  }
};
INSTANTIATE_TEST_SUITE_P(Solvers, WeakDrives, testing::ValuesIn(kJointSolvers));

TEST_P(WeakDrives, AWeakMotorTurnsAHeavyWheel) {
  for (const bool is_warm : {true, false}) {
    double moment = 0;
    Scene scene = weak_motor(moment);
    scene.solver.warm_start = is_warm;
    World world = world_of(scene);
    run_for(world, 2);
    EXPECT_NEAR(world.states().angular_velocity[0].z, 2 / moment, 0.02 / moment);
  }
}

TEST_P(WeakDrives, FrictionStopsABodyThatNothingElseHolds) {
  World world = world_of(braked_slider());
  run_for(world, 2);
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

TEST_P(WeakDrives, AnArmOfTwoSoftMotorsComesToItsPlace) {
  World world = world_of(arm_of_two_soft_motors());
  run_for(world, 25);
  const std::vector<JointRecord> joints = world.joints();
  EXPECT_NEAR(joints[0].position, 0.3, 0.01);
  EXPECT_NEAR(joints[1].position, -0.4, 0.01);
}

TEST_P(WeakDrives, ASpringSwingsBesideManyBodiesAtRest) {
  if (GetParam() == "jacobi") GTEST_SKIP() << "two hundred boxes take it long";
  World world = world_of(spring_beside_bodies_at_rest());
  EXPECT_LT(error_of_swing(world), 0.02 * 0.05);
}

/// Locked axes that keep a body in a plane, as its hinge does: rows of the hinge which they hold already have no block of their own.
TEST_P(WeakDrives, AHingeAgreesWithLockedAxes) {
  double free_x = 0, free_z = 0;
  for (const int locks : {0, int{lock_rz}, lock_rx | lock_rz, lock_y | lock_rx | lock_rz}) {
    Scene scene = default_scene();
    add_box(scene, {0.5, 0, 0}, {0.1, 0.05, 0.15}, 2).locks = static_cast<std::uint8_t>(locks);
    scene.joints = {joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0})};
    World world = world_of(scene);
    run_for(world, 0.5);
    const Vec3d x = world.states().position[0];
    if (locks == 0) {
      free_x = x.x, free_z = x.z;
      EXPECT_LT(free_z, -0.3);
    }
    EXPECT_NEAR(x.x, free_x, 2e-3) << "locks " << locks;
    EXPECT_NEAR(x.z, free_z, 2e-3) << "locks " << locks;
  }
}

/// Of contacts on body 0, in a step [N].
Vec3d force_on_first(World& world) {
  Vec3d sum;
  for (const ContactRecord& c : world.contacts())
    if (c.body_a == 0 || c.body_b == 0) sum += (c.body_b == 0 ? 1e3 : -1e3) * c.impulse;
  return sum;
}

/// Steps have converged, and what they measure is the value within 1 % in the mean, and within 4 % in each.
template <class Measure>
void expect_in_steps(World& world, double value, Measure measure) {
  constexpr int kSteps = 200;
  run_for(world, 0.5);
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    ASSERT_TRUE(world.step().converged) << k;
    const double now = measure();
    EXPECT_NEAR(now, value, 0.04 * std::abs(value)) << k;
    sum += now;
  }
  EXPECT_NEAR(sum / kSteps, value, 0.01 * std::abs(value));
}

// Their force is the load that a step is solved against, where there is no other.
TEST_P(WeakDrives, MotorsPressWithTheirForceWithoutGravity) {
  for (const JointMotor& motor :
       {JointMotor{.speed = -0.5, .max_force = kPress}, JointMotor{.force = -kPress}}) {
    World world = world_of(press(motor));
    expect_in_steps(world, -kPress, [&] { return force_on_first(world).z; });
  }
}

/// The same of motors with a position beyond what they press on: tolerances went down to rounding, or up to what bodies may sink.
TEST_P(WeakDrives, MotorsWithAPositionPressWithoutGravity) {
  for (const JointMotor& motor :
       {JointMotor{.position = -0.25, .stiffness = kPress / 0.2, .damping = 50},
        JointMotor{.position = -1, .stiffness = 1000, .damping = 100, .max_force = kPress}}) {
    World world = world_of(press(motor));
    expect_in_steps(world, -kPress, [&] { return force_on_first(world).z; });
  }
}

/// Of a block, about the hinge of lever_on_a_block() [N m].
double moment_on_block(World& world) {
  double moment = 0;
  for (const ContactRecord& c : world.contacts())
    moment += 1e3 * cross(c.point, c.body_a == 0 ? -c.impulse : c.impulse).y;
  return moment;
}

TEST_P(WeakDrives, AMotorPressesALeverWithItsMomentWithoutGravity) {
  for (const JointMotor& motor :
       {JointMotor{.speed = 1, .max_force = kPress},
        JointMotor{.position = 1.01, .stiffness = kPress, .damping = 5},
        JointMotor{.position = 2, .stiffness = kPress, .damping = 5, .max_force = kPress}}) {
    World world = world_of(lever_on_a_block(motor));
    expect_in_steps(world, kPress, [&] { return moment_on_block(world); });
  }
}

}  // namespace
}  // namespace scree::physics
