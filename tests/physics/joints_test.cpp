// Ball joints and fixed joints: closed forms. What redundant joints carry.

#include <gtest/gtest.h>

#include <algorithm>

#include "host/error.h"
#include "host/problems/body_problem.h"
#include "host/state_hash.h"
#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

/// A door of 10 kg that hangs on two hinges, one above the other, 1 m from its edge to edge and 1.6 m from hinge to hinge.
Scene door_on_two_hinges(double break_moment) {
  Scene scene = empty_scene(1e-3, 0);
  add_box(scene, {0.5, 0, 1}, {0.5, 0.025, 1}, 10);
  for (const double height : {0.2, 1.8}) {
    scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 0, {0, 0, height}));
    scene.joints.back().break_moment = break_moment;
  }
  return scene;
}

// Five rows of the two hinges are superfluous, so many impulses hold the door. As of hinges, each carries half of the weight, and
// its moment is that of a couple, nearly: with forces F, moments M and a size s of both, 2 F^2 + 2 (M / s)^2 is least.
TEST(RedundantJoints, ShareTheirLoads) {
  constexpr double kWeight = 10 * kGravity, kArm = 0.5, kApart = 1.6;
  for (const Precision precision : {Precision::double_precision, Precision::single_precision}) {
    const double near = precision == Precision::double_precision ? 1e-4 : 0.02;
    World world(door_on_two_hinges(1e9), cpu_options(1, precision));
    for (int k = 0; k < 3; ++k) world.step();
    const auto joints = world.joints();
    const Vec3d low = (1 / 1e-3) * joints[0].force, high = (1 / 1e-3) * joints[1].force;
    const double moment = (joints[0].moment.y + joints[1].moment.y) / 1e-3;
    EXPECT_NEAR(low.z, kWeight / 2, near);
    EXPECT_NEAR(high.z, kWeight / 2, near);
    EXPECT_NEAR(low.x, -high.x, near);
    EXPECT_NEAR(std::abs(moment), kWeight * kArm - std::abs(low.x) * kApart, 10 * near);
    EXPECT_NEAR(joints[0].moment.y, joints[1].moment.y, near * 1e-3);
    const double size = 0.1 * std::sqrt(0.25 + 1 + 0.025 * 0.025);
    const double force = 0.4 * kWeight * kArm / (0.25 * kApart * kApart + size * size);
    EXPECT_NEAR(std::abs(low.x), force, near * 10);
    EXPECT_GT(force, 30);
  }
  for (const double most : {0.5, 0.4}) {
    World world = reference_world(door_on_two_hinges(most));
    for (int k = 0; k < 3; ++k) world.step();
    EXPECT_EQ(world.joints()[0].is_broken, most < 0.45);
  }
}

// A ball on a string that goes round: g / (L cos) is the square of its rate.
TEST(BallJoint, ConicalPendulumGoesRoundAtItsRate) {
  const double tilt = radians(40), rate = std::sqrt(kGravity / std::cos(tilt));
  constexpr double kRadius = 0.01;
  Scene scene = empty_scene(1e-3, 0);
  const Vec3d start{std::sin(tilt), 0, -std::cos(tilt)};
  BodyDescription& bob = add_sphere(scene, start, kRadius, 1);
  bob.angular_velocity = {0, 0, rate};
  bob.velocity = cross(bob.angular_velocity, start);
  scene.joints.push_back({JointKind::ball, {0, kWorldBody}, {}});
  World world = reference_world(scene);
  double turned = 0, before = 0, sag = 0;
  for (int k = 0; k < 5000; ++k) {
    world.step();
    const Vec3d x = world.states().position[0];
    const double azimuth = std::atan2(x.y, x.x);
    turned += std::remainder(azimuth - before, 2 * kPi);
    before = azimuth;
    sag = std::max(sag, std::abs(x.z - start.z));
    EXPECT_NEAR(norm(x), 1, 1e-7);
  }
  EXPECT_NEAR(turned / (5 * rate), 1, 1e-4);
  EXPECT_LT(sag, 0.01);  // half a step of velocity
  EXPECT_NEAR(norm(world.joints()[0].force) / 1e-3, kGravity / std::cos(tilt), 0.05);
  EXPECT_EQ(norm(world.joints()[0].moment), 0);
  EXPECT_LT(dot(world.joints()[0].force, start), 1);  // on the world, the second body: outward
}

struct TopErrors {
  double angle = 0;  ///< of the precession after the run, relative
  double tilt = 0;   ///< largest change of theta [rad]
  double tip = 0;    ///< largest way of the tip [m]
};

/// A heavy symmetric top on a ball joint, in steady precession: the slow root of
///   (I1 + m L^2) cos(theta) W^2 - I3 w3 W + m g L = 0.
TopErrors precess(double h, double duration) {
  constexpr double kMass = 1, kLength = 0.1, kI1 = 1e-3, kI3 = 2e-3, kTilt = kPi / 6, kSpin = 100;
  const double a = (kI1 + kMass * kLength * kLength) * std::cos(kTilt), b = kI3 * kSpin;
  const double rate = (b - std::sqrt(b * b - 4 * a * kMass * kGravity * kLength)) / (2 * a);
  Scene scene = empty_scene(h, 0);
  const Vec3d axis{std::sin(kTilt), 0, std::cos(kTilt)};
  BodyDescription& top = add_box(scene, kLength * axis, {0.01, 0.01, kLength}, kMass);
  top.inertia = {kI1, kI1, kI3};
  top.orientation = exp_map(Vec3d{0, kTilt, 0});
  top.angular_velocity = rate * Vec3d{0, 0, 1} + (kSpin - rate * std::cos(kTilt)) * axis;
  top.velocity = cross(top.angular_velocity, kLength * axis);
  scene.joints.push_back({JointKind::ball, {kWorldBody, 0}, {}});

  World world = reference_world(scene);
  TopErrors worst;
  double turned = 0, before = 0;
  for (int k = 0; k < steps_for(scene, duration); ++k) {
    EXPECT_TRUE(world.step().converged);
    const BodyStates s = world.states();
    const Vec3d now = rotate(s.orientation[0], Vec3d{0, 0, 1});
    const double azimuth = std::atan2(now.y, now.x);
    turned += std::remainder(azimuth - before, 2 * kPi);
    before = azimuth;
    worst.tilt = std::max(worst.tilt, std::abs(std::acos(now.z) - kTilt));
    worst.tip = std::max(worst.tip, norm(s.position[0] - kLength * now));
  }
  worst.angle = std::abs(turned / (rate * world.time()) - 1);
  return worst;
}

TEST(BallJoint, TopPrecessesToSecondOrder) {
  const TopErrors coarse = precess(1e-3, 2), fine = precess(5e-4, 2);
  EXPECT_LT(coarse.angle, 0.01);
  EXPECT_LT(coarse.tip, 1.1e-7);
  EXPECT_LT(fine.tip, 1.1e-7);
  EXPECT_GT(coarse.angle / fine.angle, 3.5);
}

// A beam built into the world: it carries the weight and its moment.
TEST(FixedJoint, CantileverCarriesForceAndMoment) {
  for (const std::string solver : {"apgd", "gauss_seidel", "gauss_seidel_colored", "jacobi"}) {
    constexpr double kMass = 2, kHalf = 0.4;
    Scene scene = empty_scene(1e-3, 0);
    scene.solver.name = solver;
    add_box(scene, {kHalf, 0, 0}, {kHalf, 0.05, 0.05}, kMass);
    scene.joints.push_back({JointKind::fixed, {kWorldBody, 0}, {}});
    World world = reference_world(scene);
    for (int k = 0; k < 200; ++k) EXPECT_TRUE(world.step().converged);
    const JointRecord joint = world.joints()[0];
    const Vec3d force = 1e3 * joint.force, moment = 1e3 * joint.moment;
    EXPECT_LT(norm(force - Vec3d{0, 0, kMass * kGravity}), 1e-6);
    EXPECT_LT(norm(moment - Vec3d{0, -kMass * kGravity * kHalf, 0}), 1e-6);
    EXPECT_LT(norm(world.states().position[0] - Vec3d{kHalf, 0, 0}), 1e-9);
    EXPECT_LT(rotation_angle(world.states().orientation[0]), 1e-9);
  }
}

// Two boxes that are one: they turn freely as the whole does, about the axis of its largest moment.
TEST(FixedJoint, TwoBodiesTurnAsOne) {
  constexpr double kRate = 5;
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  for (const double x : {-0.2, 0.3}) {
    BodyDescription& box = add_box(scene, {x, 0, 0}, {0.1, 0.05, 0.07}, x < 0 ? 3 : 2);
    box.angular_velocity = {0, 0, kRate};
    box.velocity = cross(box.angular_velocity, box.position);
  }
  scene.bodies[1].orientation = exp_map(Vec3d{0, 0, 0.4});
  scene.joints.push_back({JointKind::fixed, {0, 1}, {0.1, 0.2, 0.3}});
  World world = reference_world(scene);
  for (int k = 0; k < 2000; ++k) world.step();
  const BodyStates s = world.states();
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(norm(s.angular_velocity[i] - Vec3d{0, 0, kRate}), 1e-4);
    const Vec3d expected = rotate(exp_map(Vec3d{0, 0, 2 * kRate}), scene.bodies[i].position);
    EXPECT_LT(norm(s.position[i] - expected), 1e-3) << i;
  }
  const Quatd relative = conjugate(s.orientation[0]) * s.orientation[1];
  EXPECT_LT(norm(2.0 * relative.vec() - Vec3d{0, 0, 2 * std::sin(0.2)}), 1e-8);
  EXPECT_NEAR(norm(s.position[1] - s.position[0]), 0.5, 1e-8);
}

/// A bob on an arm of 1 m that falls from the side.
Scene falling_bob() {
  Scene scene = empty_scene(2e-3, 0.5);
  add_sphere(scene, {1, 0, 0}, 0.005, 1);
  return scene;
}

// At the bottom it makes more than its radius a step, so walls on its way are searched for.
TEST(BallJoint, BodiesPassThroughWallsThatTheyAreJoinedTo) {
  Scene free = falling_bob(), post = falling_bob();
  free.joints.push_back({JointKind::ball, {0, kWorldBody}, {}});
  add_wall_box(post, {0, 0, -0.5}, {0.02, 0.02, 0.6});
  post.joints.push_back({JointKind::ball, {1, 0}, {}});
  World world = reference_world(post), expected = reference_world(free);
  for (int k = 0; k < 400; ++k) {
    EXPECT_EQ(world.step().stopped, 0) << k;
    expected.step();
    ASSERT_LT(norm(world.states().position[0] - expected.states().position[0]), 1e-8) << k;
  }
  EXPECT_LT(world.states().position[0].x, -0.5) << "it came to the other side";
}

TEST(BallJoint, AnotherWallStillStopsTheBody) {
  Scene scene = falling_bob();
  add_wall_box(scene, {0, 0, -0.5}, {0.02, 0.02, 0.6});
  scene.joints.push_back({JointKind::ball, {0, kWorldBody}, {}});
  World world = reference_world(scene);
  for (int k = 0; k < 400; ++k) world.step();
  EXPECT_GT(world.states().position[0].x, 0.02);
}

// Two spheres that swing about their joint, across the side where space repeats and away from it.
TEST(BallJoint, HoldsAcrossAPeriodicSide) {
  const auto pair_about = [](double x) {
    Scene scene = empty_scene(1e-3, 0);
    scene.gravity = {};
    scene.periodicity.periodic[0] = true;
    scene.periodicity.lower = {0, -1, -1};
    scene.periodicity.upper = {1, 1, 1};
    for (const double side : {-0.05, 0.05}) {
      BodyDescription& ball = add_sphere(scene, {x + side, 0, 0}, 0.02, 1);
      if (ball.position.x > 1) ball.position.x -= 1;
      ball.angular_velocity = {0, 0, 20 * side};
      ball.velocity = cross(ball.angular_velocity, Vec3d{side, 0, 0});
    }
    scene.bodies[1].velocity.y += 0.3;
    scene.joints.push_back({JointKind::ball, {0, 1}, {x, 0, 0}});
    return scene;
  };
  World inside = reference_world(pair_about(0.5)), across = reference_world(pair_about(1));
  for (int k = 0; k < 200; ++k) {
    inside.step();
    EXPECT_LT(across.step().max_joint_error, 1e-6) << k;
  }
  const BodyStates a = inside.states(), b = across.states();
  for (std::size_t i = 0; i < 2; ++i) {
    Vec3d apart = b.position[i] - a.position[i] - Vec3d{0.5, 0, 0};
    apart.x -= std::round(apart.x);
    EXPECT_LT(norm(apart), 1e-9) << i;
    EXPECT_LT(norm(b.velocity[i] - a.velocity[i]), 1e-8) << i;
  }
}

// A problem that cannot be stored is refused before the step has changed anything.
TEST(HingeJoint, AProblemThatCannotBeStoredCostsNothing) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver.stop = StopRule();
  add_plane(scene);
  for (int k = 0; k < 4; ++k) add_sphere(scene, {0.001 * k, 0, 0.01 + 0.0199 * k}, 0.01, 1);
  scene.joints.push_back({JointKind::hinge, {3, 4}, {0.002, 0, 0.06}, {0, 1, 0}});
  scene.joints.back().friction = 1e-3;  // a driven joint
  World world = reference_world(scene), other = reference_world(scene);
  for (int k = 0; k < 20; ++k) {
    world.step();
    other.step();
  }
  BodyProblem problem;
  EXPECT_THROW(other.step(problem), InputError);
  EXPECT_EQ(other.contacts().size(), world.contacts().size());
  EXPECT_EQ(other.step().iterations, world.step().iterations);
  EXPECT_EQ(state_hash(other.states()), state_hash(world.states()));
}

}  // namespace
}  // namespace scree::physics
