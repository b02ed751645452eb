// What acts about the two axes of universal joints.

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "host/state_hash.h"
#include "host/world_state.h"
#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kCrossStep = 1e-3, kCrossMass = 1.5;

class UniversalJoints : public JointTest {};
INSTANTIATE_TEST_SUITE_P(Precisions, UniversalJoints,
                         testing::Values(Precision::single_precision, Precision::double_precision),
                         name_of_precision);

/// A box in gimbals, without gravity: about x of the world and about its own y, or the other way round where it is the first body.
Scene box_in_gimbals(bool world_first = true) {
  Scene scene = empty_scene(kCrossStep, 0);
  scene.gravity = {};
  add_box(scene, {}, {0.3, 0.1, 0.05}, kCrossMass);
  Joint joint = joint_of(JointKind::universal, kWorldBody, 0, {}, {1, 0, 0});
  joint.second_axis = {0, 1, 0};
  if (!world_first) std::swap(joint.bodies[0], joint.bodies[1]);
  scene.joints.push_back(joint);
  return scene;
}

/// Orientation of the second body against the first with angles about the two axes.
Quatd turned_by(double first, double second) {
  return exp_map(Vec3d{first, 0, 0}) * exp_map(Vec3d{0, second, 0});
}
/// Of the box against what it should be [rad].
double error_of(const World& world, bool world_first, double first, double second) {
  const Quatd q = turned_by(first, second);
  const Quatd is = world.states().orientation[0];
  const Quatd off = conjugate(is) * (world_first ? q : conjugate(q));
  return 2 * norm(Vec3d{off.x, off.y, off.z});
}

TEST_P(UniversalJoints, AMotorTurnsAShaft) {
  for (const std::string& solver : kJointSolvers) {
    for (const bool world_first : {true, false}) {
      SCOPED_TRACE(solver + (world_first ? " world first" : " world second"));
      Scene scene = box_in_gimbals(world_first);
      scene.solver.name = solver;
      scene.joints[0].motor = JointMotor{.speed = 3};
      World first = world_of(scene);
      run_converged(first, 500);
      EXPECT_LT(error_of(first, world_first, 1.5, 0), 2e-4);
      scene.joints[0].motor.reset();
      scene.joints[0].second_turn.motor = JointMotor{.speed = -3};
      World second = world_of(scene);
      run_converged(second, 500);
      EXPECT_LT(error_of(second, world_first, 0, -1.5), 2e-4);
      EXPECT_NEAR(norm(second.states().angular_velocity[0]), 3, 1e-4);
    }
  }
}

// Both at once: the box turns about its own axis while that turns about the other, through all angles.
TEST_P(UniversalJoints, MotorsTurnBothAxesAtOnce) {
  for (const bool world_first : {true, false}) {
    Scene scene = box_in_gimbals(world_first);
    scene.joints[0].motor = JointMotor{.speed = 2};
    scene.joints[0].second_turn.motor = JointMotor{.speed = 3};
    World world = world_of(scene);
    double most = 0;
    for (int k = 1; k <= 2500; ++k) {
      ASSERT_TRUE(world.step().converged) << k;
      most = std::max(most, error_of(world, world_first, 2 * k * kCrossStep, 3 * k * kCrossStep));
    }
    EXPECT_LT(most, 1e-4);
  }
}

// Springs about both axes take the box to any two angles, each of which is that about its own axis.
TEST_P(UniversalJoints, SpringsTakeThemToAnyAngles) {
  for (const bool world_first : {true, false}) {
    for (const auto& [first, second] :
         {std::pair{0.7, -1.9}, std::pair{-2.5, 2.9}, std::pair{7.5, 0.3}, std::pair{0.4, -8.0}}) {
      Scene scene = box_in_gimbals(world_first);
      const double inertia = scene.bodies[0].inertia.z;
      const auto spring = [&](double position) {
        return JointMotor{
            .position = position, .stiffness = inertia * 100, .damping = inertia * 20};
      };
      scene.joints[0].motor = spring(first);
      scene.joints[0].second_turn.motor = spring(second);
      World world = world_of(scene);
      run_converged(world, 4000);
      const double near = is_double() ? 1e-6 : 2e-4;
      EXPECT_LT(error_of(world, world_first, first, second), near)
          << first << " " << second << world_first;
      EXPECT_NEAR(world.joints()[0].turn, first, near);
      EXPECT_NEAR(world.joints()[0].second_turn, second, near);
    }
  }
}

// The way of a heavy arm that falls: its limits stop it about either axis, and hold its weight.
TEST_P(UniversalJoints, StopAtTheLimitsOfBothAxes) {
  for (const std::string& solver : kJointSolvers) {
    for (const bool world_first : {true, false}) {
      SCOPED_TRACE(solver + (world_first ? " world first" : " world second"));
      Scene scene = empty_scene(kCrossStep, 0);
      scene.solver.name = solver;
      scene.gravity = {3, 4, -9};
      add_box(scene, {0, 0, 0.4}, {0.1, 0.2, 0.3}, kCrossMass);
      Joint joint = joint_of(JointKind::universal, kWorldBody, 0, {}, {1, 0, 0});
      joint.second_axis = {0, 1, 0};
      joint.limits = {-0.6, 0.5};
      joint.second_turn.limits = {-0.2, 0.3};
      if (!world_first) {
        // The first body is the box: what is the first axis of the world is the second one now.
        std::swap(joint.bodies[0], joint.bodies[1]);
        std::swap(joint.axis, joint.second_axis);
        joint.limits = {-0.3, 0.2};
        joint.second_turn.limits = {-0.5, 0.6};
      }
      scene.joints.push_back(joint);
      World world = world_of(scene);
      run_converged(world, 2000);
      const Quatd off = conjugate(world.states().orientation[0]) * turned_by(-0.6, 0.3);
      EXPECT_LT(2 * norm(Vec3d{off.x, off.y, off.z}), is_double() ? 1e-6 : 1e-4);
      EXPECT_LT(norm(world.states().angular_velocity[0]), is_double() ? 1e-6 : 1e-3);
      // All that the joint carries is the weight.
      const Vec3d weight = kCrossMass * scene.gravity;
      const double sign = world_first ? -1 : 1;
      const JointRecord record = world.joints()[0];
      const double near = is_double() ? 1e-5 : 2e-2;
      EXPECT_LT(norm((1 / kCrossStep) * record.force - sign * weight), near);
      EXPECT_LT(
          norm((1 / kCrossStep) * record.moment - sign * cross(world.states().position[0], weight)),
          near);
    }
  }
}

// Limits count whole turns.
TEST_P(UniversalJoints, LimitsMayBeMoreThanATurn) {
  for (const bool second : {false, true}) {
    Scene scene = box_in_gimbals();
    AxisDrive drive;
    drive.limits = {-1, 2 * kPi + 1};
    drive.motor = JointMotor{.speed = 8, .max_force = 0.5};
    if (second) {
      scene.joints[0].second_turn = drive;
    } else {
      scene.joints[0].limits = drive.limits, scene.joints[0].motor = drive.motor;
    }
    World world = world_of(scene);
    double turned = 0;
    for (int k = 0; k < 1500; ++k) {
      ASSERT_TRUE(world.step().converged) << k;
      const Vec3d w = world.states().angular_velocity[0];
      turned += kCrossStep * (second ? w.y : w.x);
    }
    EXPECT_NEAR(turned, 2 * kPi + 1, 1e-4);
    EXPECT_LT(norm(world.states().angular_velocity[0]), 1e-4);
  }
}

// Friction about an axis slows it down by M / I and holds it; the other one turns on.
TEST_P(UniversalJoints, FrictionSlowsOneAxisDown) {
  constexpr double kFriction = 0.04;
  for (const std::string& solver : kJointSolvers) {
    for (const bool second : {false, true}) {
      Scene scene = box_in_gimbals();
      scene.solver.name = solver;
      const Vec3d axis = second ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
      const double inertia = dot(axis, scene.bodies[0].inertia);
      scene.bodies[0].angular_velocity = 4.0 * axis;
      (second ? scene.joints[0].second_turn.friction : scene.joints[0].friction) = kFriction;
      World world = world_of(scene);
      const int half = static_cast<int>(4 * inertia / kFriction / kCrossStep / 2);
      run_converged(world, half);
      const double expected = 4 - kFriction / inertia * half * kCrossStep;
      EXPECT_LT(norm(world.states().angular_velocity[0] - expected * axis), 4 * exact()) << solver;
      EXPECT_NEAR(norm(world.joints()[0].moment) / kCrossStep, kFriction, kFriction * exact());
      run_converged(world, half + 20);
      EXPECT_LT(norm(world.states().angular_velocity[0]), 4 * exact());
    }
  }
}

// A pendulum between two axes is held by friction below the moment of its weight, and falls above.
TEST_P(UniversalJoints, FrictionHoldsAPendulumBelowItsMoment) {
  for (const double share : {1.02, 0.98}) {
    Scene scene = empty_scene(kCrossStep, 0);
    const BodyDescription box = add_box(scene, {0, 0.5, 0}, {0.1, 0.2, 0.05}, kCrossMass);
    Joint joint = joint_of(JointKind::universal, kWorldBody, 0, {}, {1, 0, 0});
    joint.second_axis = {0, 1, 0};
    const double weight = kCrossMass * kGravity * 0.5;
    joint.friction = share * weight;
    scene.joints.push_back(joint);
    World world = world_of(scene);
    run_converged(world, 100);
    const double inertia = box.inertia.x + kCrossMass * 0.25;
    const double expected = share > 1 ? 0 : -(1 - share) * weight / inertia * 0.1;
    EXPECT_NEAR(world.states().angular_velocity[0].x, expected,
                share > 1 ? (is_double() ? 1e-9 : 2e-5) : 0.01 * std::abs(expected));
  }
}

TEST_P(UniversalJoints, KeepTheMomentumOfTwoBodies) {
  Scene scene = two_turning_boxes(kCrossStep, {2, 3, -4});
  Joint joint = joint_of(JointKind::universal, 0, 1, {}, {0, 1, 0});
  joint.second_axis = {0, 0, 1};
  joint.limits = {-0.4, 0.5};
  joint.friction = 0.01;
  joint.second_turn.motor = JointMotor{.speed = -3, .max_force = 0.5};
  joint.second_turn.limits = {-2, 2};
  scene.joints.push_back(joint);
  World world = world_of(scene);
  expect_momentum_kept(world, scene, 1500);
}

TEST_P(UniversalJoints, BreakOfAllTheirMoments) {
  for (const double most : {0.04, 0.06}) {
    Scene scene = box_in_gimbals();
    scene.joints[0].motor = JointMotor{.force = 0.03};
    scene.joints[0].second_turn.motor = JointMotor{.force = 0.04};
    scene.joints[0].break_moment = most;  // of both: 0.05
    World world = world_of(scene);
    run_converged(world, 20);
    EXPECT_EQ(world.joints()[0].is_broken, most < 0.05);
    EXPECT_NEAR(norm(world.joints()[0].moment) / kCrossStep, most < 0.05 ? 0 : 0.05, 1e-4);
  }
}

TEST_P(UniversalJoints, GoOnFromACheckpointWithTheSameBits) {
  Scene scene = box_in_gimbals();
  Joint& joint = scene.joints[0];
  joint.limits = {-1, 7};
  joint.motor = JointMotor{.speed = 20, .max_force = 0.3};
  joint.second_turn.limits = {-8, 1};
  joint.second_turn.motor = JointMotor{.speed = -10, .max_force = 0.2};
  joint.second_turn.friction = 0.02;
  World one = world_of(scene);
  run_converged(one, 400);
  const WorldState state = one.save();
  run_converged(one, 400);
  World other = world_of(scene);
  other.restore(state);
  run_converged(other, 400);
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
}

TEST_P(UniversalJoints, ThatAreBeyondALimitAreTold) {
  Scene scene = box_in_gimbals();
  scene.joints.insert(scene.joints.begin(),
                      line_of(JointKind::cable, kWorldBody, 0, {0, 0, 9}, {0, 0, 0.05}));
  scene.joints[1].friction = 0.01;
  scene.joints[1].second_turn.limits = {0.1, 0.5};
  World world = world_of(scene);
  const StepReport report = world.step();
  EXPECT_NEAR(report.max_joint_error, 0.1 * norm(Vec3d{0.3, 0.1, 0.05}), 1e-6);
  EXPECT_EQ(report.max_joint_error_joint, 1);
  EXPECT_EQ(world.joints().size(), 2u);
}

}  // namespace
}  // namespace scree::physics
