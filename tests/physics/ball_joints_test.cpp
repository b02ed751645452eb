// Ball joints with a cone, limits and a motor about its axis, and friction.

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "host/state_hash.h"
#include "host/world_state.h"
#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kBallStep = 1e-3, kBallMass = 1.5, kArm = 0.5;

class BallJoints : public JointTest {};
INSTANTIATE_TEST_SUITE_P(Precisions, BallJoints,
                         testing::Values(Precision::single_precision, Precision::double_precision),
                         name_of_precision);

/// A box on an arm along x, held at the origin.
Scene box_on_arm(bool world_first = true, const Vec3d& half_extents = {0.2, 0.1, 0.05}) {
  Scene scene = empty_scene(kBallStep, 0);
  add_box(scene, {kArm, 0, 0}, half_extents, kBallMass);
  scene.joints.push_back(joint_of(JointKind::ball, kWorldBody, 0, {}, {1, 0, 0}));
  if (!world_first) std::swap(scene.joints[0].bodies[0], scene.joints[0].bodies[1]);
  return scene;
}

/// A body held at its center, in space without gravity.
Scene body_at_center(bool is_sphere) {
  Scene scene = empty_scene(kBallStep, 0);
  scene.gravity = {};
  if (is_sphere) {
    add_sphere(scene, {}, 0.2, kBallMass);
  } else {
    add_box(scene, {}, {0.3, 0.1, 0.05}, kBallMass);
  }
  scene.joints.push_back(joint_of(JointKind::ball, kWorldBody, 0, {}, {0, 0, 1}));
  return scene;
}

Vec3d turned(const World& world, std::size_t body, const Vec3d& axis) {
  return rotate(world.states().orientation[body], axis);
}
double angle_of(const Vec3d& x, const Vec3d& y) { return std::atan2(norm(cross(x, y)), dot(x, y)); }

/// Angle of a rotation about an axis without the swing of that axis.
double twist_of(const Quatd& q, const Vec3d& axis) {
  return std::remainder(2 * std::atan2(q.x * axis.x + q.y * axis.y + q.z * axis.z, q.w), 2 * kPi);
}

/// The twist of a body about z, counted through whole turns.
class CountedTwist {
 public:
  void follow(const Quatd& q) {
    const double twist = twist_of(q, {0, 0, 1});
    sum_ += std::remainder(twist - last_, 2 * kPi);
    last_ = twist;
  }
  double value() const { return sum_; }

 private:
  double sum_ = 0, last_ = 0;
};

// The arm falls to the side of its cone and lies there: the joint holds the moment of its weight.
TEST_P(BallJoints, ComeToRestAtTheirSwing) {
  constexpr double kSwing = 0.7;
  for (const std::string& solver : kJointSolvers) {
    for (const bool world_first : {true, false}) {
      SCOPED_TRACE(solver + (world_first ? " world first" : " world second"));
      Scene scene = box_on_arm(world_first);
      scene.solver.name = solver;
      scene.joints[0].swing = kSwing;
      World world = world_of(scene);
      double most = 0;
      for (int k = 0; k < 1000; ++k) {
        ASSERT_TRUE(world.step().converged) << k;
        most = std::max(most, angle_of(turned(world, 0, {1, 0, 0}), {1, 0, 0}));
      }
      EXPECT_NEAR(most, kSwing, is_double() ? 1e-6 : 1e-4);
      EXPECT_NEAR(angle_of(turned(world, 0, {1, 0, 0}), {1, 0, 0}), kSwing,
                  is_double() ? 1e-6 : 1e-4);
      EXPECT_LT(norm(world.states().angular_velocity[0]), is_double() ? 1e-6 : 1e-3);
      const JointRecord record = world.joints()[0];
      EXPECT_NEAR(record.position, kSwing, is_double() ? 1e-6 : 1e-4);
      const double moment = kBallMass * kGravity * kArm * std::cos(kSwing);
      EXPECT_NEAR(norm(record.moment) / kBallStep / moment, 1, is_double() ? 1e-6 : 1e-3);
      EXPECT_NEAR(norm(record.force) / kBallStep / (kBallMass * kGravity), 1,
                  is_double() ? 1e-6 : 1e-3);
    }
  }
}

double energy_of_rotation(const World& world, const Scene& scene) {
  const BodyStates s = world.states();
  const Vec3d w = rotate_back(s.orientation[0], s.angular_velocity[0]);
  return 0.5 * dot(w, hadamard(scene.bodies[0].inertia, w));
}

// A cone that a body crosses in two steps, from its middle, through it and beside it. A blow turns a box another way than the one
// that its axis goes: for a moment it is beyond a limit that it comes to that fast, with less energy than it had.
TEST_P(BallJoints, HoldFastBodiesInANarrowCone) {
  constexpr double kSwing = 0.02;
  for (const bool is_sphere : {true, false}) {
    for (const double start : {0.0, 0.013, 0.02}) {
      for (const Vec3d& spin :
           {Vec3d{14, 0, 0}, Vec3d{-14, 0, 0}, Vec3d{0, 14, 0}, Vec3d{-10, 3, 0}}) {
        Scene scene = body_at_center(is_sphere);
        scene.bodies[0].angular_velocity = spin;
        Joint& joint = scene.joints[0];
        joint.swing = kSwing;
        joint.swing_axis = Vec3d{0, -std::sin(start), std::cos(start)};
        World world = world_of(scene);
        const double energy = energy_of_rotation(world, scene);
        double widest = 0, most = 0;
        for (int k = 0; k < 200; ++k) {
          world.step();
          widest = std::max(widest, angle_of(turned(world, 0, *joint.swing_axis), {0, 0, 1}));
          most = std::max(most, energy_of_rotation(world, scene));
        }
        SCOPED_TRACE(testing::Message() << start << " " << spin.x << " " << spin.y);
        EXPECT_LT(widest, is_sphere ? kSwing + 1e-5 : 1.5 * kSwing);
        EXPECT_LT(most, energy * 1.001);
        EXPECT_LT(angle_of(turned(world, 0, *joint.swing_axis), {0, 0, 1}), kSwing + 1e-5);
      }
    }
  }
}

// A ball that runs around the rim of its cone is held there, with the speed that it has: steps end at the limit, to third order
// with one solve, and nothing works on the ball. About the axis of the cone there is no moment.
TEST_P(BallJoints, RunAroundTheRimOfTheirCone) {
  constexpr double kSwing = 0.6, kRate = 8;
  for (const bool world_first : {true, false}) {
    Scene scene = empty_scene(kBallStep, 0);
    scene.gravity = {};
    const Vec3d arm{kArm * std::sin(kSwing), 0, kArm * std::cos(kSwing)};
    BodyDescription& ball = add_sphere(scene, arm, 0.1, kBallMass);
    ball.angular_velocity = {-kRate * std::cos(kSwing) * std::sin(kSwing), 0,
                             kRate * std::sin(kSwing) * std::sin(kSwing)};
    ball.velocity = cross(ball.angular_velocity, arm);
    Joint joint = joint_of(JointKind::ball, kWorldBody, 0, {}, {0, 0, 1});
    joint.swing = kSwing;
    joint.swing_axis = normalized(arm);
    if (!world_first) {
      std::swap(joint.bodies[0], joint.bodies[1]);
      std::swap(joint.axis, *joint.swing_axis);
    }
    scene.joints.push_back(joint);
    const double spin = ball.inertia.x * ball.angular_velocity.z +
                        kBallMass * cross(ball.position, ball.velocity).z;
    World world = world_of(scene);
    for (int k = 0; k < 1500; ++k) {
      const StepReport report = world.step();
      ASSERT_TRUE(report.converged) << k;
      ASSERT_LT(report.max_joint_error, is_double() ? 2e-7 : 1e-5) << k;
    }
    const BodyStates states = world.states();
    EXPECT_NEAR(angle_of(states.position[0], {0, 0, 1}), kSwing, is_double() ? 1e-6 : 1e-4);
    EXPECT_NEAR(norm(states.velocity[0]) / (kRate * std::sin(kSwing) * kArm), 1,
                is_double() ? 1e-5 : 1e-3);
    const double now = ball.inertia.x * states.angular_velocity[0].z +
                       kBallMass * cross(states.position[0], states.velocity[0]).z;
    EXPECT_NEAR(now / spin, 1, is_double() ? 1e-5 : 1e-3);
  }
}

// About an axis that does not swing a ball joint is a hinge: the box turns until its limit stops it.
TEST_P(BallJoints, StopAtTheLimitsOfTheirTwist) {
  for (const std::string& solver : kJointSolvers) {
    for (const bool world_first : {true, false}) {
      SCOPED_TRACE(solver + (world_first ? " world first" : " world second"));
      Scene scene = body_at_center(false);
      scene.solver.name = solver;
      scene.bodies[0].angular_velocity = {0, 0, 5};
      Joint& joint = scene.joints[0];
      joint.swing = 2;
      joint.limits = {-0.5, 0.8};
      if (!world_first) {
        std::swap(joint.bodies[0], joint.bodies[1]);
        joint.limits = {-0.8, 0.5};
      }
      World world = world_of(scene);
      double most = 0;
      for (int k = 0; k < 400; ++k) {
        ASSERT_TRUE(world.step().converged) << k;
        most = std::max(most, twist_of(world.states().orientation[0], {0, 0, 1}));
      }
      EXPECT_NEAR(most, 0.8, is_double() ? 1e-6 : 1e-4);
      EXPECT_NEAR(twist_of(world.states().orientation[0], {0, 0, 1}), 0.8,
                  is_double() ? 1e-6 : 1e-4);
      EXPECT_LT(norm(world.states().angular_velocity[0]), is_double() ? 1e-6 : 1e-4);
      EXPECT_NEAR(world.joints()[0].turn, world_first ? 0.8 : -0.8, is_double() ? 1e-6 : 1e-4);
    }
  }
}

// The weight of a box beside a swung axis turns it about that until its twist is at the limit, at whatever swing.
TEST_P(BallJoints, KeepTheLimitsOfTheirTwistWhileTheySwing) {
  for (const bool world_first : {true, false}) {
    Scene scene = empty_scene(kBallStep, 0);
    BodyDescription& box = add_box(scene, {0.1, 0.2, -0.4}, {0.1, 0.2, 0.3}, kBallMass);
    box.angular_velocity = {2, -3, 6};
    box.velocity = cross(box.angular_velocity, box.position);
    Joint joint = joint_of(JointKind::ball, kWorldBody, 0, {}, {0, 0, -1});
    joint.swing = 1.2;
    joint.limits = {-0.3, 0.4};
    if (!world_first) {
      std::swap(joint.bodies[0], joint.bodies[1]);
      joint.limits = {-0.4, 0.3};
    }
    scene.joints.push_back(joint);
    World world = world_of(scene);
    double least = 0, most = 0, widest = 0;
    for (int k = 0; k < 3000; ++k) {
      const StepReport report = world.step();
      ASSERT_TRUE(report.converged) << k;
      ASSERT_LT(report.max_joint_error, is_double() ? 2e-7 : 2e-5) << k;
      const Quatd q = world.states().orientation[0];
      least = std::min(least, twist_of(q, {0, 0, -1}));
      most = std::max(most, twist_of(q, {0, 0, -1}));
      widest = std::max(widest, angle_of(rotate(q, {0, 0, 1}), {0, 0, 1}));
    }
    const double near = is_double() ? 2e-6 : 1e-4;
    EXPECT_NEAR(least, -0.3, near);
    EXPECT_NEAR(most, 0.4, near);
    EXPECT_GT(widest, 0.5);
    EXPECT_LT(widest, 1.2 + near);
  }
}

// A motor keeps the speed of the twist, whatever the swing does meanwhile.
TEST_P(BallJoints, MotorsKeepTheSpeedOfTheirTwist) {
  for (const bool world_first : {true, false}) {
    Scene scene = body_at_center(false);
    scene.bodies[0].angular_velocity = {1.5, 1, 0};
    Joint& joint = scene.joints[0];
    joint.swing = 3;
    joint.motor = JointMotor{.speed = 4};
    if (!world_first) {
      std::swap(joint.bodies[0], joint.bodies[1]);
      joint.motor->speed = -4;
    }
    World world = world_of(scene);
    CountedTwist twist;
    double widest = 0, swing_of_others = 0;
    const int steps = 1500;
    for (int k = 0; k < steps; ++k) {
      ASSERT_TRUE(world.step().converged) << k;
      const Quatd q = world.states().orientation[0];
      twist.follow(q);
      widest = std::max(widest, angle_of(rotate(q, {0, 0, 1}), {0, 0, 1}));
      swing_of_others += norm(cross(world.states().angular_velocity[0], {0, 0, 1}));
    }
    EXPECT_NEAR(twist.value() / (4 * steps * kBallStep), 1, 2e-5);
    EXPECT_GT(widest, 0.7) << "the axis swings while the motor turns about it";
    EXPECT_GT(swing_of_others / steps, 0.1);
  }
}

// The work of a torque is that along the twist, by which the energy grows.
TEST_P(BallJoints, TorquesDoTheWorkOfTheirTwist) {
  constexpr double kTorque = 0.1;
  Scene scene = body_at_center(false);
  scene.bodies[0].angular_velocity = {2, 1, 0.5};
  scene.joints[0].swing = 3;
  scene.joints[0].motor = JointMotor{.force = kTorque};
  World world = world_of(scene);
  CountedTwist twist;
  double widest = 0;
  const double before = energy_of_rotation(world, scene);
  for (int k = 0; k < 900; ++k) {
    ASSERT_TRUE(world.step().converged) << k;
    const Quatd q = world.states().orientation[0];
    twist.follow(q);
    widest = std::max(widest, angle_of(rotate(q, {0, 0, 1}), {0, 0, 1}));
  }
  EXPECT_NEAR((energy_of_rotation(world, scene) - before) / (kTorque * twist.value()), 1, 2e-3);
  EXPECT_GT(std::abs(twist.value()), 1);
  EXPECT_GT(widest, 1);
  EXPECT_LT(widest, 2.99) << "the cone is not reached";
}

// A position motor is a torsion spring.
TEST_P(BallJoints, TwistOnATorsionSpring) {
  Scene scene = body_at_center(false);
  scene.bodies[0].angular_velocity = {0, 0, 1};
  Joint& joint = scene.joints[0];
  joint.swing = 1;
  joint.motor = JointMotor{.position = 0, .stiffness = scene.bodies[0].inertia.z * 100};
  World world = world_of(scene);
  const double period = period_of(
      world, 3000, [&] { return world.states().angular_velocity[0].z; }, [](const StepReport&) {});
  EXPECT_NEAR(period, 2 * kPi / 10, 1e-4);
}

// In whatever direction a ball turns friction slows it down by M / I and leaves that direction, until the ball rests.
TEST_P(BallJoints, FrictionSlowsABallDownInAnyDirection) {
  constexpr double kFriction = 0.05;
  for (const std::string& solver : kJointSolvers) {
    for (const Vec3d& spin : {Vec3d{3, 0, 0}, Vec3d{0, -2, 2}, Vec3d{1, 2, -1.5}}) {
      SCOPED_TRACE(solver);
      Scene scene = body_at_center(true);
      scene.solver.name = solver;
      scene.bodies[0].angular_velocity = spin;
      scene.joints[0].friction = kFriction;
      const double slower = kFriction / scene.bodies[0].inertia.x;
      World world = world_of(scene);
      const int half = static_cast<int>(norm(spin) / slower / kBallStep / 2);
      run_converged(world, half);
      const Vec3d expected = (1 - slower * half * kBallStep / norm(spin)) * spin;
      EXPECT_LT(norm(world.states().angular_velocity[0] - expected), norm(spin) * exact());
      EXPECT_NEAR(norm(world.joints()[0].moment) / kBallStep, kFriction, kFriction * exact());
      run_converged(world, half + 20);
      EXPECT_LT(norm(world.states().angular_velocity[0]), norm(spin) * exact());
      EXPECT_LT(norm(world.joints()[0].moment) / kBallStep, kFriction * 1e-3 + exact());
    }
  }
}

// Of a body with three different moments of inertia too the moment of friction is against its turning, and as large.
TEST_P(BallJoints, FrictionIsAgainstTheTurningOfAnyBody) {
  constexpr double kFriction = 0.03;
  for (const std::string& solver : kJointSolvers) {
    Scene scene = body_at_center(false);
    scene.solver.name = solver;
    scene.bodies[0].orientation = exp_map(Vec3d{0.5, -0.8, 0.3});
    scene.bodies[0].angular_velocity = {3, -2, 4};
    scene.joints[0].friction = kFriction;
    World world = world_of(scene);
    for (int k = 0; k < 300; ++k) {
      ASSERT_TRUE(world.step().converged) << k;
      const Vec3d moment = (1 / kBallStep) * world.joints()[0].moment;
      const Vec3d w = world.states().angular_velocity[0];
      ASSERT_NEAR(norm(moment), kFriction, kFriction * exact()) << solver << k;
      if (k % 50 != 0) continue;
      // Over a step free rotation turns the axis of rotation by some 2e-3.
      EXPECT_LT(norm(moment + (kFriction / norm(w)) * w), 3e-3 * kFriction) << solver << k;
    }
  }
}

// A pendulum whose weight has less moment than friction gives stays where it is, however it stands; one with more falls.
TEST_P(BallJoints, FrictionHoldsAPendulumBelowItsMoment) {
  const double weight = kBallMass * kGravity * kArm;
  for (const double angle : {0.0, 0.5, 2.0}) {
    for (const double share : {1.02, 0.98}) {
      Scene scene = box_on_arm();
      scene.gravity = kGravity * Vec3d{0, std::sin(angle), -std::cos(angle)};
      scene.joints[0].friction = share * weight;
      World world = world_of(scene);
      run_converged(world, 100);
      const Vec3d w = world.states().angular_velocity[0];
      const JointRecord record = world.joints()[0];
      if (share > 1) {
        EXPECT_LT(norm(w), is_double() ? 1e-9 : 2e-5) << angle;
        EXPECT_NEAR(norm(record.moment) / kBallStep / weight, 1, is_double() ? 1e-8 : 1e-4);
        EXPECT_NEAR(world.states().position[0].x, kArm, is_double() ? 1e-9 : 1e-6);
      } else {
        // The moment of inertia about the joint differs by direction: what is left turns the arm.
        const Vec3d i = scene.bodies[0].inertia;
        const Vec3d about = cross(Vec3d{1, 0, 0}, scene.gravity) * (1 / kGravity);
        const double own = i.y * about.y * about.y + i.z * about.z * about.z;
        const double around = kBallMass * kArm * kArm;
        EXPECT_NEAR(dot(w, about) / ((1 - share) * weight / (own + around) * 0.1), 1, 0.01)
            << angle;
      }
    }
  }
}

// What a joint of two free bodies does about its swing, its twist and its friction leaves their momentum and where it is.
TEST_P(BallJoints, KeepTheMomentumOfTwoBodies) {
  Scene scene = two_turning_boxes(kBallStep, {-5, 2, 4});
  Joint joint = joint_of(JointKind::ball, 0, 1, {}, {1, 0, 0});
  joint.swing = 0.5;
  joint.limits = {-0.4, 0.3};
  joint.friction = 0.01;
  joint.motor = JointMotor{.force = 0.02};
  scene.joints.push_back(joint);
  World world = world_of(scene);
  expect_momentum_kept(world, scene, 1000);
  const Quatd a = world.states().orientation[0], b = world.states().orientation[1];
  EXPECT_LT(angle_of(rotate(a, {1, 0, 0}), rotate(b, {1, 0, 0})), 0.5 + 1e-4);
  const double twist = twist_of(conjugate(a) * b, {1, 0, 0});
  EXPECT_GT(twist, -0.4 - 1e-4);
  EXPECT_LT(twist, 0.3 + 1e-4);
}

// Friction and motor add up to what breaks a joint, and nothing holds or turns its body after that.
TEST_P(BallJoints, BreakOfAllTheirMoments) {
  for (const double most : {0.06, 0.08}) {
    Scene scene = body_at_center(false);
    scene.bodies[0].angular_velocity = {0, 0, 5};
    Joint& joint = scene.joints[0];
    joint.swing = 1;
    joint.friction = 0.03;
    joint.motor = JointMotor{.force = -0.04};
    joint.break_moment = most;
    World world = world_of(scene);
    run_converged(world, 50);
    const bool breaks = most < 0.07;
    EXPECT_EQ(world.joints()[0].is_broken, breaks);
    EXPECT_NEAR(world.states().angular_velocity[0].z,
                5 - 0.07 / scene.bodies[0].inertia.z * kBallStep * (breaks ? 1 : 50), 1e-5);
    EXPECT_NEAR(world.joints()[0].moment.z / kBallStep, breaks ? 0 : -0.07, 1e-6);
    ASSERT_EQ(world.joints().size(), 1u);
  }
}

// forces.csv has them all as well.
TEST_P(BallJoints, TellOfAllTheirMoments) {
  Scene scene = body_at_center(false);
  scene.bodies[0].angular_velocity = {0, 0, 5};
  Joint& joint = scene.joints[0];
  joint.swing = 1;
  joint.friction = 0.03;
  joint.motor = JointMotor{.force = -0.04};
  World world = world_of(scene);
  world.track_forces();
  run_converged(world, 20);
  const MeanForces forces = world.take_forces();
  ASSERT_EQ(forces.on_joints.size(), 1u);
  EXPECT_LT(norm(forces.on_joints[0].torque - Vec3d{0, 0, -0.07}), is_double() ? 1e-10 : 1e-6);
}

TEST_P(BallJoints, GoOnFromACheckpointWithTheSameBits) {
  Scene scene = box_on_arm();
  scene.bodies[0].angular_velocity = {3, 0, 0};
  Joint& joint = scene.joints[0];
  joint.swing = 0.5;
  joint.limits = {-3, 7};
  joint.motor = JointMotor{.speed = 20, .max_force = 0.1};
  joint.friction = 0.02;
  World one = world_of(scene);
  for (int k = 0; k < 400; ++k) one.step();
  const WorldState state = one.save();
  for (int k = 0; k < 400; ++k) one.step();
  World other = world_of(scene);
  other.restore(state);
  for (int k = 0; k < 400; ++k) other.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
  EXPECT_EQ(one.joints()[0].moment, other.joints()[0].moment);
}

TEST_P(BallJoints, ThatAreBeyondTheirSwingAreToldAndComeBack) {
  Scene scene = body_at_center(false);
  Joint& joint = scene.joints[0];
  joint.swing = 0.3;
  joint.swing_axis = Vec3d{std::sin(0.5), 0, std::cos(0.5)};
  World world = world_of(scene);
  const StepReport report = world.step();
  const double radius = norm(Vec3d{0.3, 0.1, 0.05});
  EXPECT_NEAR(report.max_joint_error, 0.2 * radius, 1e-6);
  EXPECT_EQ(report.max_joint_error_joint, 0);
  for (int k = 0; k < 1000; ++k) world.step();
  EXPECT_NEAR(angle_of(turned(world, 0, *joint.swing_axis), {0, 0, 1}), 0.3, 1e-4);
}

}  // namespace
}  // namespace scree::physics
