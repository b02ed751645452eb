// What acts along and about the axis of cylindrical joints, which leave both free.

#include <gtest/gtest.h>

#include "host/state_hash.h"
#include "host/world_state.h"
#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kAxisStep = 1e-3, kAxisMass = 1.5;

class CylindricalJoints : public JointTest {};
INSTANTIATE_TEST_SUITE_P(Precisions, CylindricalJoints,
                         testing::Values(Precision::single_precision, Precision::double_precision),
                         name_of_precision);

/// A box on a vertical axis through its center, with its moment of inertia about it.
Scene box_on_axis(double& inertia, bool world_first = true) {
  Scene scene = empty_scene(kAxisStep, 0);
  inertia = add_box(scene, {}, {0.2, 0.2, 0.05}, kAxisMass).inertia.z;
  scene.joints.push_back(joint_of(JointKind::cylindrical, kWorldBody, 0, {0, 0, 0.4}, {0, 0, 1}));
  if (!world_first) std::swap(scene.joints[0].bodies[0], scene.joints[0].bodies[1]);
  return scene;
}

double axial_speed(const World& world) { return world.states().velocity[0].z; }
double axial_spin(const World& world) { return world.states().angular_velocity[0].z; }

// A limit holds the weight, and the box goes on turning.
TEST_P(CylindricalJoints, StopAtBothEndsOfTheirWay) {
  for (const std::string& solver : kJointSolvers) {
    for (const bool world_first : {true, false}) {
      double inertia = 0;
      Scene scene = box_on_axis(inertia, world_first);
      scene.solver.name = solver;
      scene.bodies[0].velocity = {0, 0, 3};
      scene.bodies[0].angular_velocity = {0, 0, 5};
      scene.joints[0].limits = {-0.25, 0.2};
      if (!world_first) scene.joints[0].limits = {-0.2, 0.25};
      World world = world_of(scene);
      double high = 0, low = 0;
      for (int k = 0; k < 1000; ++k) {
        world.step();
        high = std::max(high, world.states().position[0].z);
        low = std::min(low, world.states().position[0].z);
      }
      EXPECT_NEAR(high, 0.2, 1e-5) << solver << world_first;
      EXPECT_NEAR(low, -0.25, 1e-5);
      EXPECT_NEAR(world.states().position[0].z, -0.25, 1e-5);
      EXPECT_NEAR(axial_spin(world), 5, 5 * exact());
      EXPECT_NEAR(std::abs(world.joints()[0].force.z) / kAxisStep / (kAxisMass * kGravity), 1,
                  is_double() ? 1e-6 : 5e-4);
    }
  }
}

TEST_P(CylindricalJoints, FrictionHoldsThemAndSlowsThemDown) {
  constexpr double kWeight = kAxisMass * kGravity;
  for (const double share : {1.2, 0.4}) {
    double inertia = 0;
    Scene scene = box_on_axis(inertia);
    scene.bodies[0].angular_velocity = {0, 0, 5};
    scene.joints[0].friction = share * kWeight;
    World world = world_of(scene);
    run_converged(world, 200);
    const double expected = share > 1 ? 0 : -(1 - share) * kGravity * 200 * kAxisStep;
    EXPECT_NEAR(axial_speed(world), expected, is_double() ? 1e-9 : 1e-4) << share;
    EXPECT_NEAR(axial_spin(world), 5, 5 * exact());
  }
}

TEST_P(CylindricalJoints, MotorsMoveThemAlong) {
  double inertia = 0;
  Scene scene = box_on_axis(inertia);
  scene.bodies[0].angular_velocity = {0, 0, 5};
  scene.joints[0].motor = JointMotor{.speed = 0.5, .max_force = 100};
  World keeps = world_of(scene);
  run_converged(keeps, 200);
  EXPECT_NEAR(axial_speed(keeps), 0.5, 1e-5);
  EXPECT_NEAR(axial_spin(keeps), 5, 5 * exact());
  scene.joints[0].motor = JointMotor{.force = 4};
  World pushes = world_of(scene);
  run_converged(pushes, 200);
  EXPECT_NEAR(axial_speed(pushes), (4 / kAxisMass - kGravity) * 200 * kAxisStep,
              is_double() ? 1e-9 : 1e-4);
  EXPECT_NEAR(pushes.joints()[0].force.z, 4 * kAxisStep, 4 * kAxisStep * exact());
}

// About the axis: the box falls freely meanwhile, or is carried.
TEST_P(CylindricalJoints, ATorqueTurnsThem) {
  for (const std::string& solver : kJointSolvers) {
    for (const bool world_first : {true, false}) {
      double inertia = 0;
      Scene scene = box_on_axis(inertia, world_first);
      scene.solver.name = solver;
      scene.joints[0].turn.motor = JointMotor{.force = world_first ? 0.02 : -0.02};
      World world = world_of(scene);
      run_converged(world, 300);
      EXPECT_NEAR(axial_spin(world) / (0.02 / inertia * 300 * kAxisStep), 1, exact()) << solver;
      EXPECT_NEAR(axial_speed(world), -kGravity * 300 * kAxisStep, is_double() ? 1e-9 : 1e-4);
      const JointRecord record = world.joints()[0];
      EXPECT_NEAR(std::abs(record.moment.z) / kAxisStep, 0.02, 0.02 * exact());
      ASSERT_EQ(world.joints().size(), 1u);
      EXPECT_NEAR(std::abs(record.position), 0.5 * kGravity * 0.3 * 0.3, 1e-2);  // the way, in m
    }
  }
}

TEST_P(CylindricalJoints, FrictionStopsTheirTurn) {
  double inertia = 0;
  Scene scene = box_on_axis(inertia);
  scene.bodies[0].angular_velocity = {0, 0, 4};
  scene.joints[0].turn.friction = 0.2;
  World world = world_of(scene);
  const int half = static_cast<int>(4 * inertia / 0.2 / kAxisStep / 2);
  run_converged(world, half);
  EXPECT_NEAR(axial_spin(world), 4 - 0.2 / inertia * half * kAxisStep, 4 * exact());
  run_converged(world, half + 20);
  EXPECT_NEAR(axial_spin(world), 0, exact());
}

// Limits about the axis count whole turns; a motor drives the box there. The other way is limited too.
TEST_P(CylindricalJoints, HaveLimitsOfBothWays) {
  for (const bool world_first : {true, false}) {
    double inertia = 0;
    Scene scene = box_on_axis(inertia, world_first);
    const double sign = world_first ? 1 : -1, end = 2 * kPi + 1;
    scene.joints[0].limits = {-0.1, 0.1};
    scene.joints[0].turn.limits = {-1, end};
    if (!world_first) scene.joints[0].turn.limits = {-end, 1};
    scene.joints[0].turn.motor = JointMotor{.speed = sign * 8, .max_force = 5};
    World world = world_of(scene);
    run_converged(world, 1500);
    const Vec3d x = rotate(world.states().orientation[0], {1, 0, 0});
    EXPECT_NEAR(std::remainder(std::atan2(x.y, x.x) - end, 2 * kPi), 0, 1e-4) << world_first;
    EXPECT_NEAR(axial_spin(world), 0, 1e-4);
    EXPECT_NEAR(world.states().position[0].z, -0.1, 1e-5);
    EXPECT_NEAR(world.joints()[0].moment.z / kAxisStep, 0,
                1e-3);  // the limit takes what the motor gives
    EXPECT_NEAR(world.joints()[0].force.z / kAxisStep, sign * kAxisMass * kGravity, 1e-2);
  }
}

// An axis beside the center of a body with three different moments, askew: both ways act on each other.
TEST_P(CylindricalJoints, AreDrivenBothWaysAtOnce) {
  for (const std::string& solver : kJointSolvers) {
    Scene scene = empty_scene(kAxisStep, 0);
    BodyDescription& box = add_box(scene, {0.3, 0.1, 0}, {0.3, 0.1, 0.05}, kAxisMass);
    box.orientation = exp_map(Vec3d{0.4, -0.3, 0.8});
    scene.joints.push_back(
        joint_of(JointKind::cylindrical, kWorldBody, 0, {}, normalized(Vec3d{0.2, -0.1, 1})));
    scene.solver.name = solver;
    Joint& joint = scene.joints[0];
    joint.motor = JointMotor{.speed = 0.3};
    joint.turn.motor = JointMotor{.speed = -2};
    World world = world_of(scene);
    run_converged(world, 200);
    EXPECT_NEAR(dot(world.states().angular_velocity[0], joint.axis), -2, 1e-4) << solver;
    EXPECT_NEAR(world.joints()[0].position, 0.3 * 199 * kAxisStep, 1e-5);
    EXPECT_NEAR(world.joints()[0].turn, -2 * 199 * kAxisStep, 1e-4);
    EXPECT_LT(norm(cross(world.states().angular_velocity[0], joint.axis)), 1e-3);
  }
}

// A position motor is a torsion spring about the axis.
TEST_P(CylindricalJoints, SwingOnATorsionSpring) {
  double inertia = 0;
  Scene scene = box_on_axis(inertia);
  scene.gravity = {};
  const double stiffness = inertia * 100;  // 10 rad/s
  scene.bodies[0].velocity = {0, 0, 0.1};
  scene.bodies[0].angular_velocity = {0, 0, 1};
  scene.joints[0].turn.motor = JointMotor{.position = 0, .stiffness = stiffness};
  World world = world_of(scene);
  const double period = period_of(
      world, 3000, [&] { return axial_spin(world); }, [](const StepReport&) {});
  EXPECT_NEAR(period, 2 * kPi / 10, 1e-4);
  EXPECT_NEAR(axial_speed(world), 0.1, 1e-5);
}

// The whole moment breaks a joint, and nothing turns it after that.
TEST_P(CylindricalJoints, BreakWithTheirTurn) {
  for (const double most : {0.05, 0.01}) {
    double inertia = 0;
    Scene scene = box_on_axis(inertia);
    scene.joints[0].turn.motor = JointMotor{.force = 0.02};
    scene.joints[0].break_moment = most;
    World world = world_of(scene);
    run_converged(world, 50);
    const bool breaks = most < 0.02;
    EXPECT_EQ(world.joints()[0].is_broken, breaks);
    EXPECT_NEAR(axial_spin(world), 0.02 / inertia * kAxisStep * (breaks ? 1 : 50), 1e-5);
    EXPECT_NEAR(world.joints()[0].moment.z / kAxisStep, breaks ? 0 : 0.02, 1e-6);
  }
}

TEST_P(CylindricalJoints, GoOnFromACheckpointWithTheSameBits) {
  double inertia = 0;
  Scene scene = box_on_axis(inertia);
  scene.joints[0].turn.limits = {-1, 7};
  scene.joints[0].turn.motor = JointMotor{.speed = 20, .max_force = 1};
  scene.joints[0].limits = {-0.3, 0.3};
  World one = world_of(scene);
  run_converged(one, 400);
  const WorldState state = one.save();
  run_converged(one, 200);
  World other = world_of(scene);
  other.restore(state);
  run_converged(other, 200);
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
}

TEST_P(CylindricalJoints, ThatAreBeyondALimitOfTheirTurnAreTold) {
  double inertia = 0;
  Scene scene = box_on_axis(inertia);
  scene.joints.insert(scene.joints.begin(),
                      line_of(JointKind::cable, kWorldBody, 0, {0, 0, 9}, {0, 0, 0.05}));
  scene.joints[1].turn.limits = {0.1, 0.5};
  World world = world_of(scene);
  const StepReport report = world.step();
  const double radius = norm(Vec3d{0.2, 0.2, 0.05});
  EXPECT_NEAR(report.max_joint_error, 0.1 * radius, 1e-6);
  EXPECT_EQ(report.max_joint_error_joint, 1);
  EXPECT_EQ(world.joints().size(), 2u);
}

}  // namespace
}  // namespace scree::physics
