// What acts along or about the axis of a joint: limits, motors, springs, friction; joints that break.

#include <gtest/gtest.h>

#include <algorithm>

#include "host/world_state.h"
#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kStep = 1e-3;

class JointDrives : public JointTest {
 protected:
  /// Share of a force that solvers leave undone in a step.
  double left() const { return is_double() ? 1e-6 : 5e-4; }
};
INSTANTIATE_TEST_SUITE_P(Precisions, JointDrives,
                         testing::Values(Precision::single_precision, Precision::double_precision),
                         name_of_precision);

constexpr double kMass = 1.2, kHalfExtents = 0.5, kThick = 0.02;
/// Of the rod below about its hinge.
constexpr double kAboutHinge =
    kMass *
    ((4 * kHalfExtents * kHalfExtents + 4 * kThick * kThick) / 12 + kHalfExtents * kHalfExtents);

/// A rod that lies along x from its hinge at the origin; about +y its far end goes down.
Scene rod_on_hinge(bool world_first = true) {
  Scene scene = empty_scene(kStep, 0);
  add_box(scene, {kHalfExtents, 0, 0}, {kHalfExtents, kThick, kThick}, kMass);
  Joint hinge = joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0});
  if (!world_first) std::swap(hinge.bodies[0], hinge.bodies[1]);
  scene.joints.push_back(hinge);
  return scene;
}

/// A disc about the y axis that nothing loads.
Scene flywheel(double& moment_of_inertia) {
  Scene scene = empty_scene(kStep, 0);
  scene.gravity = {};
  moment_of_inertia = add_box(scene, {}, {0.2, 0.05, 0.2}, 3).inertia.y;
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0}));
  return scene;
}

double rate(const World& world) { return world.states().angular_velocity[0].y; }

// Falls, is stopped at its limit and stays; the limit carries the weight's moment.
TEST_P(JointDrives, HingeStopsAtItsLimitAndStays) {
  constexpr double kLimit = 0.6;
  for (const std::string& solver : kJointSolvers) {
    for (const bool world_first : {true, false}) {
      Scene scene = rod_on_hinge(world_first);
      scene.solver.name = solver;
      scene.joints[0].limits = {-kLimit, 3};
      if (world_first) scene.joints[0].limits = {-3, kLimit};
      World world = world_of(scene);
      EnergyOfSteps energy(world, scene);
      double least = energy.start(), deepest = 0;
      for (int k = 0; k < 1500; ++k) {
        EXPECT_TRUE(world.step().converged) << solver << k;
        const Vec3d along = rotate(world.states().orientation[0], {1, 0, 0});
        deepest = std::max(deepest, std::atan2(-along.z, along.x));
        const double now = energy.of_step(world);
        EXPECT_LT(now, least + 1e-4);
        least = std::min(least, now);
      }
      EXPECT_NEAR(deepest, kLimit, is_double() ? 1e-6 : 1e-4) << solver << world_first;
      const Vec3d along = rotate(world.states().orientation[0], {1, 0, 0});
      EXPECT_NEAR(std::atan2(-along.z, along.x), kLimit, is_double() ? 1e-7 : 1e-4);
      EXPECT_LT(norm(world.states().angular_velocity[0]), 1e-4);
      const JointRecord record = world.joints()[0];
      EXPECT_NEAR(record.position, world_first ? kLimit : -kLimit, 1e-4);
      const double expected = -kMass * kGravity * kHalfExtents * std::cos(kLimit);  // on the rod
      EXPECT_NEAR(record.moment.y / kStep / expected, world_first ? 1 : -1, left());
    }
  }
}

TEST_P(JointDrives, HingeDoesNotFeelLimitsThatItDoesNotReach) {
  Scene scene = rod_on_hinge();
  World free = world_of(scene);
  scene.joints[0].limits = {-4, 4};
  World limited = world_of(scene);
  for (int k = 0; k < 400; ++k) {
    free.step();
    limited.step();
    EXPECT_NEAR(limited.joints()[0].moment.y, 0, 1e-12);
  }
  EXPECT_LT(norm(free.states().position[0] - limited.states().position[0]),
            is_double() ? 1e-9 : 1e-4);
}

// Limits count whole turns.
TEST_P(JointDrives, HingeTurnsThreeTimesToItsLimit) {
  double inertia = 0;
  Scene scene = flywheel(inertia);
  scene.bodies[0].angular_velocity = {0, 20, 0};
  scene.joints[0].limits = {-1, 6 * kPi + 0.5};
  World world = world_of(scene);
  for (int k = 0; k < 1200; ++k) world.step();
  EXPECT_NEAR(world.joints()[0].position, 6 * kPi + 0.5, 1e-4);
  EXPECT_NEAR(rate(world), 0, is_double() ? 1e-9 : 1e-4);
}

TEST_P(JointDrives, SliderStopsAtBothEnds) {
  Scene scene = empty_scene(kStep, 0);
  add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 1).velocity = {0, 0, 3};
  Joint slider = joint_of(JointKind::slider, kWorldBody, 0, {0.3, 0, 0}, {0, 0, 1});
  slider.limits = {-0.25, 0.2};
  scene.joints.push_back(slider);
  World world = world_of(scene);
  double high = 0, low = 0;
  for (int k = 0; k < 1000; ++k) {
    world.step();
    high = std::max(high, world.states().position[0].z);
    low = std::min(low, world.states().position[0].z);
  }
  EXPECT_NEAR(high, 0.2, 1e-5);
  EXPECT_NEAR(low, -0.25, 1e-5);
  EXPECT_NEAR(world.states().position[0].z, -0.25, 1e-5);
  EXPECT_NEAR(world.joints()[0].force.z / kStep / kGravity, 1, left());
}

// A speed motor accelerates with its largest moment, then keeps its speed and gives nothing.
TEST_P(JointDrives, MotorReachesItsSpeed) {
  double inertia = 0;
  Scene scene = flywheel(inertia);
  constexpr double kSpeed = 5, kMoment = 0.4;
  scene.joints[0].motor = JointMotor{.speed = kSpeed, .max_force = kMoment};
  World world = world_of(scene);
  const double time = kSpeed * inertia / kMoment;
  ASSERT_GT(time, 0.3);
  const int half = static_cast<int>(time / kStep / 2);
  for (int k = 0; k < half; ++k) world.step();
  EXPECT_NEAR(rate(world), kMoment / inertia * half * kStep, 1e-4);
  EXPECT_NEAR(world.joints()[0].moment.y / kStep, kMoment, 1e-4);
  for (int k = 0; k < half + 20; ++k) world.step();
  EXPECT_NEAR(rate(world), kSpeed, 1e-4);
  EXPECT_NEAR(world.joints()[0].moment.y / kStep, 0, 1e-3);
}

// A motor of speed zero is a brake: it holds a rod below its bound and gives way above.
TEST_P(JointDrives, MotorStallsAtItsBound) {
  const double load = kMass * kGravity * kHalfExtents;
  for (const std::string& solver : kJointSolvers) {
    for (const double share : {1.01, 0.6}) {
      Scene scene = rod_on_hinge();
      scene.solver.name = solver;
      scene.joints[0].motor = JointMotor{.speed = 0, .max_force = share * load};
      World world = world_of(scene);
      for (int k = 0; k < 50; ++k) EXPECT_TRUE(world.step().converged) << solver;
      const double given = -world.joints()[0].moment.y / kStep;
      if (share > 1) {
        EXPECT_NEAR(given / load, 1, left()) << solver;
        EXPECT_NEAR(rate(world), 0, 1e-5);
      } else {
        EXPECT_NEAR(given / load, share, left()) << solver;
        // cos(angle) has changed by less than 1e-3.
        EXPECT_NEAR(rate(world), (load - share * load) / kAboutHinge * 50 * kStep, 1e-3);
      }
    }
  }
}

TEST_P(JointDrives, MotorMovesASlider) {
  Scene scene = empty_scene(kStep, 0);
  add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 2);
  Joint slider = joint_of(JointKind::slider, 0, kWorldBody, {}, {0, 0, 1});
  slider.motor = JointMotor{.speed = -0.5, .max_force = 100};  // the world goes down from the box
  scene.joints.push_back(slider);
  World world = world_of(scene);
  for (int k = 0; k < 400; ++k) world.step();
  EXPECT_NEAR(world.states().velocity[0].z, 0.5, 1e-5);
  EXPECT_NEAR(world.joints()[0].force.z / kStep, -2 * kGravity, 1e-2);
}

// A motor with a torque gives that, whichever body comes first, however weak it is, at any speed.
TEST_P(JointDrives, MotorGivesItsTorque) {
  constexpr double kTorque = 0.05;
  constexpr int kSteps = 300;
  for (const std::string& solver : kJointSolvers) {
    for (const double sign : {1.0, -1.0}) {
      for (const bool world_first : {true, false}) {
        double inertia = 0;
        Scene scene = flywheel(inertia);
        scene.solver.name = solver;
        if (!world_first) std::swap(scene.joints[0].bodies[0], scene.joints[0].bodies[1]);
        scene.joints[0].motor = JointMotor{.force = sign * kTorque};
        World world = world_of(scene);
        for (int k = 0; k < kSteps; ++k) EXPECT_TRUE(world.step().converged) << solver << k;
        const double gained = sign * kTorque / inertia * kSteps * kStep;
        EXPECT_NEAR(rate(world) / (world_first ? gained : -gained), 1, is_double() ? 1e-9 : 1e-5)
            << solver << sign << world_first;
        EXPECT_NEAR(world.joints()[0].moment.y / kStep / (sign * kTorque), 1,
                    is_double() ? 1e-9 : 1e-6);
      }
    }
  }
}

TEST_P(JointDrives, MotorGivesItsForce) {
  Scene scene = empty_scene(kStep, 0);
  add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 2);
  scene.joints.push_back(joint_of(JointKind::slider, kWorldBody, 0, {0.2, 0, 0}, {0, 0, 1}));
  for (const double force : {-7.0, 3.0, 2 * kGravity}) {  // the last one is the weight
    scene.joints[0].motor = JointMotor{.force = force};
    World world = world_of(scene);
    for (int k = 0; k < 300; ++k) EXPECT_TRUE(world.step().converged) << force << k;
    const double gained = (force / 2 - kGravity) * 300 * kStep;
    EXPECT_NEAR(world.states().velocity[0].z, gained, is_double() ? 1e-9 : 1e-4) << force;
    EXPECT_NEAR(world.joints()[0].force.z / kStep / force, 1, is_double() ? 1e-9 : 1e-6);
  }
}

// What else acts on the joint adds to it: friction against the motion, a limit, damping.
TEST_P(JointDrives, TorqueIsBesideFrictionLimitsAndDamping) {
  double inertia = 0;
  Scene scene = flywheel(inertia);
  const double exact = is_double() ? 1e-6 : 1e-4;
  scene.joints[0].motor = JointMotor{.force = 0.4};
  scene.joints[0].friction = 0.1;
  World rubs = world_of(scene);
  for (int k = 0; k < 300; ++k) rubs.step();
  EXPECT_NEAR(rate(rubs) / (0.3 / inertia * 300 * kStep), 1, exact);
  scene.joints[0].friction = 0.5;
  World holds = world_of(scene);
  for (int k = 0; k < 300; ++k) holds.step();
  EXPECT_NEAR(rate(holds), 0, exact);
  scene.joints[0].friction = 0;
  scene.joints[0].limits = {-1, 0.2};
  World stops = world_of(scene);
  for (int k = 0; k < 1000; ++k) stops.step();
  EXPECT_NEAR(stops.joints()[0].position, 0.2, exact);
  EXPECT_NEAR(stops.joints()[0].moment.y, 0, kStep * 0.4 * exact);
  scene.joints[0].limits = Joint{}.limits;
  scene.joints[0].motor->damping = 0.2;  // I w' = T - c w
  World damped = world_of(scene);
  for (int k = 0; k < 500; ++k) damped.step();
  const double fall = std::pow(1 + kStep * 0.2 / inertia, -500);
  EXPECT_NEAR(rate(damped), 0.4 / 0.2 * (1 - fall), 2 * exact);
}

// A motor that pushes against a limit: what the limit gives is the difference.
TEST_P(JointDrives, MotorPushesAgainstALimit) {
  for (const std::string& solver : kJointSolvers) {
    Scene scene = rod_on_hinge();
    scene.solver.name = solver;
    scene.joints[0].limits = {-0.3, 0.3};
    scene.joints[0].motor = JointMotor{.speed = -4, .max_force = 30};  // lifts
    World world = world_of(scene);
    for (int k = 0; k < 400; ++k) EXPECT_TRUE(world.step().converged) << solver << k;
    EXPECT_NEAR(world.joints()[0].position, -0.3, 1e-4) << solver;
    EXPECT_NEAR(rate(world), 0, 1e-4);
    EXPECT_NEAR(world.joints()[0].moment.y / kStep,
                -kMass * kGravity * kHalfExtents * std::cos(0.3), 1e-2);
  }
}

// A position motor with gains is a torsion spring and a damper.
TEST_P(JointDrives, PositionMotorSwingsAsASpring) {
  double inertia = 0;
  Scene scene = flywheel(inertia);
  constexpr double kStiffness = 50, kTarget = 0.4;
  const double damping = 0.05 * 2 * std::sqrt(kStiffness * inertia);
  for (const double c : {0.0, damping}) {
    scene.joints[0].motor = JointMotor{.position = kTarget, .stiffness = kStiffness, .damping = c};
    World world = world_of(scene);
    const double undamped = std::sqrt(kStiffness / inertia), ratio = c / (2 * inertia * undamped);
    const double expected = 2 * kPi / (undamped * std::sqrt(1 - ratio * ratio));
    double top = 0, bottom = 1, first_over = 0, second_over = 0;
    int steps = 0;
    const auto angle = [&] {
      const Vec3d x = rotate(world.states().orientation[0], {1, 0, 0});
      return std::atan2(-x.z, x.x);
    };
    const double found = period_of(
        world, 2500, [&] { return angle() - kTarget; },
        [&](const StepReport&) {
          const double now = angle(), t = ++steps * kStep;
          top = std::max(top, now);
          bottom = std::min(bottom, now);
          if (t < expected) first_over = std::max(first_over, now - kTarget);
          if (t > expected && t < 2 * expected) second_over = std::max(second_over, now - kTarget);
        });
    EXPECT_NEAR(found / expected, 1, 1e-3);
    EXPECT_NEAR(second_over / first_over, std::exp(-ratio * undamped * expected), 5e-3);
    if (c == 0) {
      EXPECT_NEAR(top, 2 * kTarget, 1e-3);  // and back, for ever
      EXPECT_NEAR(bottom, 0, 1e-3);
    }
  }
}

TEST_P(JointDrives, PositionMotorGivesNoMoreThanItsBound) {
  double inertia = 0;
  Scene scene = flywheel(inertia);
  scene.joints[0].motor =
      JointMotor{.position = 3, .stiffness = 1e4, .damping = 100, .max_force = 0.2};
  World world = world_of(scene);
  for (int k = 0; k < 100; ++k) world.step();
  EXPECT_NEAR(world.joints()[0].moment.y / kStep, 0.2, 1e-5);
  EXPECT_NEAR(rate(world), 0.2 / inertia * 100 * kStep, 1e-4);
}

/// A ball on a spring below the origin; its rest is 1 m below.
Scene ball_on_spring(double stiffness, double damping) {
  Scene scene = empty_scene(kStep, 0);
  add_sphere(scene, {0, 0, -1}, 0.05, 2);
  Joint spring = line_of(JointKind::spring, kWorldBody, 0, {}, {0, 0, -1});
  spring.stiffness = stiffness;
  spring.damping = damping;
  scene.joints.push_back(spring);
  return scene;
}

// Period, amplitude and decrement of a mass on a spring; the force where it comes to rest.
TEST_P(JointDrives, SpringSwingsInItsPeriod) {
  constexpr double kStiffness = 200, kOwnMass = 2;
  const double undamped = std::sqrt(kStiffness / kOwnMass), sag = kOwnMass * kGravity / kStiffness;
  for (const double ratio : {0.0, 0.03}) {
    const Scene scene = ball_on_spring(kStiffness, 2 * ratio * kOwnMass * undamped);
    World world = world_of(scene);
    double lowest = 0, highest = -2;
    int steps = 0;
    const double expected = 2 * kPi / (undamped * std::sqrt(1 - ratio * ratio));
    const double decrement = std::exp(-ratio * undamped * expected);
    double first = 0, fourth = 0;
    const double found = period_of(
        world, 2600, [&] { return world.states().position[0].z + 1 + sag; },
        [&](const StepReport&) {
          const double z = world.states().position[0].z, t = ++steps * kStep;
          lowest = std::min(lowest, z);
          highest = std::max(highest, z);
          const double swing = -1 - sag - z;
          if (t < expected) first = std::max(first, swing);
          if (t > 3 * expected) fourth = std::max(fourth, swing);
        });
    EXPECT_NEAR(found / expected, 1, 1e-3);
    EXPECT_NEAR(fourth / first / std::pow(decrement, 3), 1, 1e-2);
    EXPECT_NEAR(lowest, -1 - sag * (1 + std::sqrt(decrement)), 1e-3);
    if (ratio == 0) {
      EXPECT_NEAR(highest, -1, 1e-3);  // four swings cost nothing
    }
  }
  World world = world_of(ball_on_spring(kStiffness, 40));
  for (int k = 0; k < 3000; ++k) world.step();
  EXPECT_NEAR(world.states().position[0].z, -1 - sag, 1e-5);
  EXPECT_NEAR(world.joints()[0].force.z / kStep / (kOwnMass * kGravity), 1, left());
}

// A damper alone: v = v_0 exp(-c t / m).
TEST_P(JointDrives, DamperSlowsDown) {
  Scene scene = ball_on_spring(0, 4);
  scene.gravity = {};
  scene.bodies[0].velocity = {0, 0, -1};
  World world = world_of(scene);
  for (int k = 0; k < 500; ++k) world.step();
  EXPECT_NEAR(world.states().velocity[0].z, -std::exp(-4 * 0.5 / 2), 1e-3);
}

// A spring whose own period is a hundredth of the step is a rod: it gains no energy.
TEST_P(JointDrives, StiffSpringIsStable) {
  for (const double damping : {0.0, 10.0}) {
    Scene scene = ball_on_spring(1e9, damping);
    scene.stepping.time_step = 1e-2;
    scene.bodies[0].velocity = {1, 0, 0};
    World world = world_of(scene);
    scene.joints[0].kind = JointKind::distance;
    World rod = world_of(scene);
    EnergyOfSteps energy(world, scene), of_rod(rod, scene);
    double most = -1e9, most_of_rod = -1e9;
    for (int k = 0; k < 1000; ++k) {
      world.step();
      rod.step();
      most = std::max(most, energy.of_step(world));
      most_of_rod = std::max(most_of_rod, of_rod.of_step(rod));
      EXPECT_NEAR(norm(world.states().position[0]), 1, 1e-3);
      if (k == 200) {
        EXPECT_LT(norm(world.states().position[0] - rod.states().position[0]), 1e-3);
      }
    }
    EXPECT_LT(most, most_of_rod + 5e-3);
  }
}

// Two springs side by side and a chain of two: stiffnesses add, and their inverses do.
TEST_P(JointDrives, SpringsAddUp) {
  Scene scene = empty_scene(kStep, 0);
  scene.gravity = {0, 0, -kGravity};
  add_sphere(scene, {0, 0, -1}, 0.05, 1);
  add_sphere(scene, {0, 0, -2}, 0.05, 3);
  for (const auto& [a, b, from, to] : {std::tuple{kWorldBody, 0, Vec3d{}, Vec3d{0, 0, -1}},
                                       std::tuple{0, kWorldBody, Vec3d{0, 0, -1}, Vec3d{}},
                                       std::tuple{0, 1, Vec3d{0, 0, -1}, Vec3d{0, 0, -2}}}) {
    Joint spring = line_of(JointKind::spring, a, b, from, to);
    spring.stiffness = 500;
    spring.damping = 30;
    scene.joints.push_back(spring);
  }
  World world = world_of(scene);
  for (int k = 0; k < 4000; ++k) world.step();
  const double first = -1 - 4 * kGravity / 1000;
  EXPECT_NEAR(world.states().position[0].z, first, 1e-4);
  EXPECT_NEAR(world.states().position[1].z, first - 1 - 3 * kGravity / 500, 1e-4);
}

// Friction slows a wheel at a constant rate and then keeps it at rest.
TEST_P(JointDrives, FrictionStopsAWheel) {
  double inertia = 0;
  Scene scene = flywheel(inertia);
  constexpr double kMoment = 0.3, kStart = 4;
  scene.bodies[0].angular_velocity = {0, kStart, 0};
  scene.joints[0].friction = kMoment;
  World world = world_of(scene);
  const double time = kStart * inertia / kMoment;
  const int half = static_cast<int>(time / kStep / 2);
  for (int k = 0; k < half; ++k) world.step();
  EXPECT_NEAR(rate(world), kStart - kMoment / inertia * half * kStep, 1e-4);
  EXPECT_NEAR(world.joints()[0].moment.y / kStep, -kMoment, 1e-4);
  for (int k = 0; k < half + 50; ++k) world.step();
  EXPECT_NEAR(rate(world), 0, 1e-7);
}

// A rod sticks below the friction of its hinge, and a motor works against it.
TEST_P(JointDrives, FrictionHoldsAndAMotorOvercomesIt) {
  const double load = kMass * kGravity * kHalfExtents;
  Scene scene = rod_on_hinge();
  scene.joints[0].friction = 1.05 * load;
  World world = world_of(scene);
  for (int k = 0; k < 100; ++k) world.step();
  EXPECT_NEAR(rate(world), 0, 1e-6);
  EXPECT_NEAR(world.joints()[0].moment.y / kStep / load, -1, left());

  for (const std::string& solver : kJointSolvers) {
    double inertia = 0;
    Scene wheel = flywheel(inertia);
    wheel.solver.name = solver;
    wheel.joints[0].friction = 0.1;
    wheel.joints[0].motor = JointMotor{.speed = 50, .max_force = 0.4};
    World driven = world_of(wheel);
    for (int k = 0; k < 100; ++k) EXPECT_TRUE(driven.step().converged) << solver;
    EXPECT_NEAR(rate(driven), 0.3 / inertia * 100 * kStep, 1e-4) << solver;
    EXPECT_NEAR(driven.joints()[0].moment.y / kStep, 0.3, 1e-4);
  }
}

// Holds a weight below its strength; carries none above it, for good.
TEST_P(JointDrives, JointBreaksAboveItsStrength) {
  for (const JointKind kind : {JointKind::ball, JointKind::distance, JointKind::cable}) {
    for (const double share : {1.01, 0.99}) {
      Scene scene = empty_scene(kStep, 0);
      add_sphere(scene, {0, 0, 0}, 0.1, 2);
      Joint joint = line_of(kind, kWorldBody, 0, {0, 0, 1}, {0, 0, 0});
      if (kind == JointKind::ball) joint.anchor = {};
      joint.break_force = share * 2 * kGravity;
      scene.joints.push_back(joint);
      World world = world_of(scene);
      for (int k = 0; k < 101; ++k) EXPECT_TRUE(world.step().converged);
      EXPECT_EQ(world.joints()[0].is_broken, share < 1);
      const double fall = share < 1 ? 0.5 * kGravity * 0.1 * 0.101 : 0;
      EXPECT_NEAR(world.states().position[0].z, -fall, 1e-5);
      EXPECT_NEAR(world.joints()[0].force.z / kStep, share < 1 ? 0 : 2 * kGravity, 1e-3);
    }
  }
  Scene scene = rod_on_hinge();
  scene.joints[0].kind = JointKind::fixed;
  scene.joints[0].break_moment = 0.9 * kMass * kGravity * kHalfExtents;
  World world = world_of(scene);
  for (int k = 0; k < 5; ++k) world.step();
  EXPECT_TRUE(world.joints()[0].is_broken);
}

// Turns and breaks are part of a saved state.
TEST_P(JointDrives, GoOnBitForBitFromASavedState) {
  double inertia = 0;
  Scene scene = flywheel(inertia);
  scene.bodies[0].angular_velocity = {0, 20, 0};
  scene.joints[0].limits = {-1, 4 * kPi};
  add_sphere(scene, {3, 0, 0}, 0.1, 1).velocity = {0, 0, -5};
  Joint weak = joint_of(JointKind::ball, kWorldBody, 1, {3, 0, 0});
  weak.break_force = 1;
  scene.joints.push_back(weak);
  World world = world_of(scene);
  for (int k = 0; k < 500; ++k) world.step();  // 10 rad
  ASSERT_TRUE(world.joints()[1].is_broken);
  World resumed = world_of(scene);
  resumed.restore(world.save());
  for (int k = 0; k < 500; ++k) world.step(), resumed.step();
  EXPECT_NEAR(world.joints()[0].position, 4 * kPi, 1e-3);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(world.states().position[i], resumed.states().position[i]);
    EXPECT_EQ(world.states().angular_velocity[i], resumed.states().angular_velocity[i]);
  }
  EXPECT_TRUE(resumed.joints()[1].is_broken);
}

}  // namespace
}  // namespace scree::physics
