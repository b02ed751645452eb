// Sliders, cylindrical and universal joints, rods and cables: closed forms.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

class JointKinds : public JointTest {};
INSTANTIATE_TEST_SUITE_P(Precisions, JointKinds,
                         testing::Values(Precision::single_precision, Precision::double_precision),
                         name_of_precision);

// Down an incline, held at a point beside its center: x = g sin(slope) t (t + h) / 2.
TEST_P(JointKinds, SliderGoesDownItsIncline) {
  const double slope = radians(25);
  const Vec3d down{std::cos(slope), 0, -std::sin(slope)};
  for (const bool world_first : {false, true}) {
    Scene scene = empty_scene(1e-3, 0);
    add_box(scene, {0, 0, 0}, {0.1, 0.2, 0.05}, 2);
    Joint slider = joint_of(JointKind::slider, kWorldBody, 0, {0.05, 0.3, -0.2}, down);
    if (!world_first) std::swap(slider.bodies[0], slider.bodies[1]);
    scene.joints.push_back(slider);
    World world = world_of(scene);
    const int steps = 500;
    double error = 0;
    for (int k = 0; k < steps; ++k) error = world.step().max_joint_error;
    const double t = steps * 1e-3, way = 0.5 * kGravity * std::sin(slope) * t * (t + 1e-3);
    const BodyStates s = world.states();
    EXPECT_LT(norm(s.position[0] - way * down), is_double() ? 1e-9 : 1e-5);
    EXPECT_LT(norm(rotate(s.orientation[0], {1, 2, 3}) - Vec3d{1, 2, 3}),
              is_double() ? 1e-9 : 1e-5);
    EXPECT_LT(error, is_double() ? 1e-9 : 1e-5);
    const JointRecord record = world.joints().at(0);
    const double sign = world_first ? 1 : -1;  // the second body against the first
    const double last = 0.5 * kGravity * std::sin(slope) * (t - 1e-3) * t;
    EXPECT_NEAR(record.position, sign * last, is_double() ? 1e-9 : 1e-5);
    // What is across the incline is carried: on the box from the world.
    EXPECT_NEAR(dot(record.force, {std::sin(slope), 0, std::cos(slope)}) * 1e3,
                sign * 2 * kGravity * std::cos(slope), 1e-3);
    EXPECT_NEAR(dot(record.force, down), 0, 1e-6);
  }
}

// A guide that turns throws its slider outward: r = r_0 cosh(w t).
TEST_P(JointKinds, SliderGoesOutOnATurningGuide) {
  constexpr double kRate = 2, kStart = 0.3, kStep = 1e-3;
  Scene scene = empty_scene(kStep, 0);
  scene.gravity = {};
  BodyDescription& guide = add_wall_box(scene, {0, 0, 0}, {0.01, 0.01, 0.01}, BodyKind::kinematic);
  Motion motion;
  motion.kind = Motion::Kind::rotating;
  motion.rate = kRate;
  guide.motion = motion;
  BodyDescription& bead = add_sphere(scene, {kStart, 0, 0}, 0.02, 1);
  bead.velocity = Vec3d{0, kStart * kRate, 0};
  bead.angular_velocity = {0, 0, kRate};
  scene.joints.push_back(joint_of(JointKind::slider, 0, 1, {0, 0, 0}, {1, 0, 0}));
  World world = world_of(scene);
  double error = 0;
  for (int k = 0; k < 1000; ++k) error = std::max(error, world.step().max_joint_error);
  const double expected = kStart * std::cosh(kRate);
  EXPECT_NEAR(norm(world.states().position[1]) / expected, 1, is_double() ? 1e-5 : 1e-4);
  EXPECT_LT(error, 2e-6);
}

// A cart of 2 kg hangs from a level rail, 0.5 m from where it began. What the joint tells of its moment is about the anchor of its
// second body: the cart's own center, or the start of the rail, whether the rail belongs to the world or to a body held by it.
TEST_P(JointKinds, SliderTellsTheMomentAboutTheAnchorOfItsSecondBody) {
  for (const bool rail_is_free : {false, true}) {
    for (const bool cart_first : {false, true}) {
      Scene scene = empty_scene(0.01, 0);
      scene.gravity = {1, 0, -9.81};
      add_box(scene, {}, {0.1, 0.1, 0.1}, 2).velocity = {1, 0, 0};
      add_box(scene, {0, 0, 1}, {0.1, 0.1, 0.1}, 3);
      scene.joints.push_back(joint_of(JointKind::fixed, kWorldBody, 1, {0, 0, 1}));
      Joint slider = joint_of(JointKind::slider, rail_is_free ? 1 : kWorldBody, 0, {}, {1, 0, 0});
      slider.limits = {0, 0.5};
      if (cart_first) {
        std::swap(slider.bodies[0], slider.bodies[1]);
        slider.limits = {-0.5, 0};
      }
      scene.joints.push_back(slider);
      World world = joint_world(scene, GetParam());
      for (int k = 0; k < 100; ++k) world.step();
      EXPECT_NEAR(world.states().position[0].x, 0.5, 1e-5);
      const JointRecord told = world.joints()[1];
      const double side = cart_first ? -1 : 1;
      EXPECT_LT(norm((1 / 0.01) * told.force - side * Vec3d{-2, 0, 2 * 9.81}), 1e-2);
      const Vec3d expected = cart_first ? Vec3d{0, 0.5 * 2 * 9.81, 0} : Vec3d{};
      EXPECT_LT(norm((1 / 0.01) * told.moment - expected), 1e-2);
    }
  }
}

// Falls along the axis, which is upright, and keeps turning about it; nothing else.
TEST_P(JointKinds, CylinderFallsAndTurns) {
  Scene scene = empty_scene(1e-3, 0);
  BodyDescription& box = add_box(scene, {0.3, 0, 0}, {0.1, 0.05, 0.2}, 1);
  constexpr double kRate = 2;
  box.angular_velocity = {0, 0, kRate};
  box.velocity = {0, 0.3 * kRate, 0};
  scene.joints.push_back(joint_of(JointKind::cylindrical, kWorldBody, 0, {0, 0, 0.1}, {0, 0, 1}));
  World world = world_of(scene);
  for (int k = 0; k < 500; ++k) world.step();
  const BodyStates s = world.states();
  const double fall = 0.5 * kGravity * 0.5 * 0.501;
  EXPECT_NEAR(s.position[0].z, -fall, is_double() ? 1e-8 : 1e-5);
  const Vec3d expected{0.3 * std::cos(kRate * 0.5), 0.3 * std::sin(kRate * 0.5), -fall};
  EXPECT_LT(norm(s.position[0] - expected), 1e-4);
  EXPECT_NEAR(s.angular_velocity[0].z, kRate, 1e-4);
}

// Two shafts at an angle: tan(out) = tan(in) cos(bend), so the ratio of their rates goes between
// cos(bend) and its inverse.
TEST_P(JointKinds, UniversalJointTurnsUnevenly) {
  const double bend = radians(35);
  constexpr double kRate = 3, kStep = 1e-3;
  const Vec3d out{std::cos(bend), std::sin(bend), 0};
  Scene scene = empty_scene(kStep, 0);
  scene.gravity = {};
  BodyDescription& drive =
      add_wall_box(scene, {-0.3, 0, 0}, {0.1, 0.02, 0.02}, BodyKind::kinematic);
  Motion motion;
  motion.kind = Motion::Kind::rotating;
  motion.axis = {1, 0, 0};
  motion.rate = kRate;
  drive.motion = motion;
  BodyDescription& shaft = add_box(scene, 0.3 * out, {0.1, 0.05, 0.05}, 1);
  shaft.orientation = exp_map(Vec3d{0, 0, bend});
  shaft.angular_velocity = kRate * std::cos(bend) * out;
  Joint cross_joint = joint_of(JointKind::universal, 0, 1, {}, {0, 0, 1});
  cross_joint.second_axis = {-std::sin(bend), std::cos(bend), 0};
  // The bearing of the shaft, which leaves the place along it to the cross.
  scene.joints.push_back(joint_of(JointKind::cylindrical, kWorldBody, 1, 0.4 * out, out));
  scene.joints.push_back(cross_joint);
  World world = world_of(scene);
  double worst = 0, slow = 10, fast = 0, error = 0;
  for (int k = 1; k <= 2100; ++k) {  // a whole turn
    error = std::max(error, world.step().max_joint_error);
    const BodyStates s = world.states();
    const double in = kRate * k * kStep;
    const double expected = std::atan2(std::sin(in) * std::cos(bend), std::cos(in));
    const Vec3d side = rotate(s.orientation[1], {0, 1, 0});
    const double found = std::atan2(side.z, dot(side, {-std::sin(bend), std::cos(bend), 0}));
    worst = std::max(worst, std::abs(std::remainder(found - expected, 2 * kPi)));
    const double ratio = dot(s.angular_velocity[1], out) / kRate;
    const double middle = in - kRate * kStep / 2;
    const double law = std::cos(bend) / (1 - std::pow(std::sin(bend) * std::sin(middle), 2));
    EXPECT_NEAR(ratio / law, 1, 2e-3);
    slow = std::min(slow, ratio);
    fast = std::max(fast, ratio);
  }
  EXPECT_LT(worst, 5e-5);
  EXPECT_NEAR(slow / std::cos(bend), 1, 1e-3);
  EXPECT_NEAR(fast * std::cos(bend), 1, 1e-3);
  EXPECT_LT(error, 1e-5);
}

// A rod without mass between two points swings as a pendulum of its length.
TEST_P(JointKinds, DistanceIsAPendulum) {
  Scene scene = empty_scene(1e-3, 0);
  const double tilt = radians(60);
  const Vec3d bob{std::sin(tilt), 0, 2 - std::cos(tilt)};
  add_sphere(scene, bob, 0.01, 1);
  scene.joints.push_back(line_of(JointKind::distance, kWorldBody, 0, {0, 0, 2}, bob));
  World world = world_of(scene);
  double error = 0;
  const double period = period_of(
      world, 6000, [&] { return world.states().position[0].x; },
      [&](const StepReport& r) { error = std::max(error, r.max_joint_error); });
  EXPECT_NEAR(period / (2 * kPi * std::sqrt(1 / kGravity) * 1.0731820), 1, 1e-4);
  EXPECT_LT(error, is_double() ? 1e-7 : 1e-5);
}

// Two rods of the distance kind between two free balls that turn about each other: their distance
// stays, and so does their momentum.
TEST_P(JointKinds, DistanceHoldsTwoBodiesThatTurn) {
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  add_sphere(scene, {-0.5, 0, 0}, 0.05, 1).velocity = {0.1, -1, 0};
  add_sphere(scene, {0.5, 0, 0}, 0.05, 3).velocity = {0.1, 1.0 / 3, 0};
  scene.joints.push_back(line_of(JointKind::distance, 1, 0, {0.5, 0, 0}, {-0.5, 0, 0}));
  World world = world_of(scene);
  for (int k = 0; k < 3000; ++k) world.step();
  const BodyStates s = world.states();
  EXPECT_NEAR(norm(s.position[1] - s.position[0]), 1, is_double() ? 1e-6 : 1e-5);
  EXPECT_LT(norm(s.velocity[0] + 3.0 * s.velocity[1] - Vec3d{0.4, 0, 0}),
            is_double() ? 1e-9 : 1e-3);
  // Tension m v^2 / r of the light one, at 0.75 from the center of both.
  EXPECT_NEAR(norm(world.joints()[0].force) * 1e3, 1 / 0.75, 2e-2);
}

TEST_P(JointKinds, DistancePullsToItsLength) {
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  add_sphere(scene, {1.02, 0, 0}, 0.05, 1);
  scene.joints.push_back(line_of(JointKind::distance, kWorldBody, 0, {}, {1.02, 0, 0}));
  scene.joints[0].length = 1;
  World world = world_of(scene);
  const StepReport first = world.step();
  EXPECT_NEAR(first.max_joint_error, 0.02, 1e-7);
  EXPECT_EQ(first.max_joint_error_joint, 0);
  for (int k = 0; k < 100; ++k) world.step();
  EXPECT_NEAR(world.states().position[0].x, 1, 1e-6);
}

TEST_P(JointKinds, TheJointThatIsFarthestOffIsTold) {
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  for (int k = 0; k < 5; ++k) {
    const Vec3d at{1, static_cast<double>(k), 0};
    add_sphere(scene, at, 0.05, 1);
    scene.joints.push_back(line_of(JointKind::distance, k, kWorldBody, at, {0, at.y, 0}));
    scene.joints.back().length = k == 3 ? 0.97 : 1.01;
  }
  EXPECT_EQ(world_of(scene).step().max_joint_error_joint, 3);
  scene.joints[3].length = 1;
  EXPECT_EQ(world_of(scene).step().max_joint_error_joint,
            0);  // the first of those that are off as far
  for (Joint& joint : scene.joints) joint.length = 1;
  EXPECT_EQ(world_of(scene).step().max_joint_error_joint, -1);
  scene.joints.clear();
  EXPECT_EQ(world_of(scene).step().max_joint_error_joint, -1);
}

// Falls freely until the cable is taut, then hangs from it; the cable never pushes and gives no energy.
TEST_P(JointKinds, CableStopsAFallAndNeverPushes) {
  for (const std::string& solver : kJointSolvers) {
    Scene scene = empty_scene(1e-3, 0);
    scene.solver.name = solver;
    add_box(scene, {0.1, 0, 0}, {0.2, 0.02, 0.02}, 1);  // by its end, so that it turns
    Joint cable = line_of(JointKind::cable, kWorldBody, 0, {0.1, 0, 0.1}, {-0.1, 0, 0});
    cable.length = 0.5;
    scene.joints.push_back(cable);
    World world = world_of(scene);
    EnergyOfSteps energy(world, scene);
    double least = energy.start(), longest = 0, pull = 0;
    for (int k = 0; k < 3000; ++k) {
      const StepReport report = world.step();
      EXPECT_TRUE(report.converged) << solver << " " << k;
      const JointRecord record = world.joints()[0];
      const BodyStates s = world.states();
      const Vec3d end = s.position[0] + rotate(s.orientation[0], {-0.2, 0, 0});
      const Vec3d along = end - Vec3d{0.1, 0, 0.1};
      longest = std::max(longest, norm(along));
      EXPECT_LT(dot(record.force, along), 1e-7);  // on the box, toward the world
      pull = std::max(pull, norm(record.force));
      if (norm(along) < 0.45) {
        EXPECT_EQ(norm(record.force), 0);
      }
      const double now = energy.of_step(world);
      EXPECT_LT(now, least + 5e-3) << k;  // of 4 J; it swings by the square of the step
      least = std::min(least, now);
    }
    EXPECT_GT(pull, 0.1);
    EXPECT_LT(longest, 0.5 + 1e-4) << solver;
    EXPECT_GT(longest, 0.4999);
  }
}

// A block hangs from a cable at rest: the cable carries its weight.
TEST_P(JointKinds, CableCarriesAWeight) {
  Scene scene = empty_scene(1e-3, 0);
  add_sphere(scene, {0, 0, 0}, 0.1, 2);
  scene.joints.push_back(line_of(JointKind::cable, 0, kWorldBody, {0, 0, 0}, {0, 0, 1}));
  World world = world_of(scene);
  for (int k = 0; k < 200; ++k) world.step();
  EXPECT_NEAR(world.joints()[0].force.z * 1e3, -2 * kGravity, 1e-3);  // on the world
  EXPECT_LT(norm(world.states().position[0]), 1e-6);
}

// A door on two hinges of one axis: the second one holds what the first one holds already.
TEST_P(JointKinds, DoorSwingsOnTwoHinges) {
  for (const std::string& solver : kJointSolvers) {
    Scene scene = empty_scene(1e-3, 0);
    scene.solver.name = solver;
    constexpr double kHalf = 0.4, kRate = 1.5;
    BodyDescription& door = add_box(scene, {kHalf, 0, 0}, {kHalf, 0.02, 1}, 20);
    door.angular_velocity = {0, 0, kRate};
    door.velocity = {0, kHalf * kRate, 0};
    for (const double z : {-0.8, 0.8})
      scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 0, {0, 0, z}, {0, 0, 1}));
    World world = world_of(scene);
    double error = 0;
    for (int k = 0; k < 400; ++k) {
      const StepReport report = world.step();
      EXPECT_TRUE(report.converged) << solver << k;
      error = std::max(error, report.max_joint_error);
    }
    const BodyStates s = world.states();
    EXPECT_LT(norm(s.position[0] - kHalf * Vec3d{std::cos(kRate * 0.4), std::sin(kRate * 0.4), 0}),
              1e-4)
        << solver;
    EXPECT_LT(error, is_double() ? 2e-7 : 2e-6);
    const std::vector<JointRecord> joints = world.joints();
    EXPECT_NEAR((joints[0].force.z + joints[1].force.z) * 1e3, 20 * kGravity, 0.05);
  }
}

// Two rods of different lengths between the same points: steps end above the tolerance and say so,
// with the joint and what is left of it; the ball stays between the two lengths.
TEST_P(JointKinds, ContradictionIsToldByTheSteps) {
  Scene scene = empty_scene(1e-3, 0);
  add_sphere(scene, {0, 0, -1}, 0.05, 1);
  for (const double length : {0.98, 1.02}) {
    scene.joints.push_back(line_of(JointKind::distance, kWorldBody, 0, {}, {0, 0, -1}));
    scene.joints.back().length = length;
  }
  scene.solver.stop = {StopRule::Level::quality, 0};
  scene.solver.max_iterations = 300;
  World world(scene, cpu_options(1, GetParam()));
  for (int k = 0; k < 20; ++k) {
    const StepReport report = world.step();
    EXPECT_FALSE(report.converged);
    // Of two rods that pull against each other at 0.5 m/s, the fastest recovery, both keep that.
    EXPECT_NEAR(report.residual_rms, 0.5, 0.05);
    EXPECT_EQ(report.residual_max_body_a, 0);
    EXPECT_EQ(report.residual_max_body_b, kWorldBody);
    EXPECT_GT(report.max_joint_error, 0.0199);
    EXPECT_NEAR(world.states().position[0].z, -1, 0.021);
  }
}

}  // namespace
}  // namespace scree::physics
