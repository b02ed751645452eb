// Motors, springs, friction and limits of joints of affine bodies, in closed forms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynamics/affine/affine_card.h"
#include "dynamics/affine/affine_setup.h"
#include "host/error.h"
#include "host/state_hash.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/physics/joint_scenes.h"

namespace scree::affine {
namespace {

using namespace test;
using physics::add_box;
using physics::joint_of;
using physics::kGravity;
using physics::kPi;

constexpr double kStep = 2e-3;
constexpr double kMass = 1.2, kHalf = 0.5, kThick = 0.02;
constexpr double kLoad = kMass * kGravity * kHalf;  // moment of the rod below about its hinge
constexpr double kAboutHinge =
    kMass * ((4 * kHalf * kHalf + 4 * kThick * kThick) / 12 + kHalf * kHalf);

Scene driven_scene(double rule) {
  Scene scene = affine_scene(kStep, 0, rule);
  scene.dynamics.parameters["tolerance"] = 1e-9;
  return scene;
}

/// A rod that lies along x from its hinge at the origin; about +y its far end goes down.
Scene rod_on_hinge(double rule, bool world_first = true) {
  Scene scene = driven_scene(rule);
  add_box(scene, {kHalf, 0, 0}, {kHalf, kThick, kThick}, kMass);
  Joint hinge = joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0});
  if (!world_first) std::swap(hinge.bodies[0], hinge.bodies[1]);
  scene.joints.push_back(hinge);
  return scene;
}

/// A disc about the y axis that nothing loads.
Scene flywheel(double rule, double& moment_of_inertia) {
  Scene scene = driven_scene(rule);
  scene.gravity = {};
  moment_of_inertia = add_box(scene, {}, {0.2, 0.05, 0.2}, 3).inertia.y;
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0}));
  return scene;
}

/// A motor that gives less than the load, in a scene whose size makes the default tolerance large.
Scene weak_motor_beside_a_large_plate() {
  Scene scene = affine_scene(0.01, 0.5, 1);
  add_box(scene, {kHalf, 0, 0}, {kHalf, 0.05, 0.05}, 10);
  physics::add_wall_box(scene, {0, 0, -1}, {2.5, 2.5, 0.05});
  Joint hinge = joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0});
  hinge.motor = JointMotor{.speed = 0, .max_force = 30};
  scene.joints = {hinge};
  return scene;
}

double rate(const World& world, std::size_t body = 0) {
  return world.states().angular_velocity[body].y;
}
double angle(const World& world) {
  const Vec3d x = rotate(world.states().orientation[0], {1, 0, 0});
  return std::atan2(-x.z, x.x);
}
void run(World& world, int steps) {
  for (int k = 0; k < steps; ++k) ASSERT_TRUE(world.step().converged) << k;
}

class AffineDrives : public testing::TestWithParam<double> {};  // rules of steps
INSTANTIATE_TEST_SUITE_P(Rules, AffineDrives, testing::Values(0.0, 1.0));

// A speed motor accelerates with its largest moment, then keeps its speed.
TEST_P(AffineDrives, MotorReachesItsSpeed) {
  double inertia = 0;
  Scene scene = flywheel(GetParam(), inertia);
  constexpr double kSpeed = 5, kMoment = 0.4;
  scene.joints[0].motor = JointMotor{.speed = kSpeed, .max_force = kMoment};
  World world(scene, cpu_options());
  const int half = static_cast<int>(kSpeed * inertia / kMoment / kStep / 2);
  ASSERT_GT(half, 50);
  run(world, half);
  // A state that changes by 5 kStep a step is stretched by the square of that.
  EXPECT_NEAR(rate(world) / (kMoment / inertia * half * kStep), 1, 0.01);
  run(world, half + 60);
  EXPECT_NEAR(rate(world) / kSpeed, 1, 1e-3);
}

TEST_P(AffineDrives, MotorWithoutABoundKeepsItsSpeedUnderLoad) {
  Scene scene = rod_on_hinge(GetParam());
  scene.joints[0].motor = JointMotor{.speed = -2};
  World world(scene, cpu_options());
  run(world, 250);
  EXPECT_NEAR(rate(world), -2, 2e-3);
  EXPECT_NEAR(angle(world), -1, 1e-3);
}

// A motor of speed zero is a brake: it holds a rod below its bound and gives way above.
TEST_P(AffineDrives, MotorStallsAtItsBound) {
  for (const bool world_first : {true, false}) {
    for (const double share : {1.01, 0.6}) {
      Scene scene = rod_on_hinge(GetParam(), world_first);
      scene.joints[0].motor = JointMotor{.speed = 0, .max_force = share * kLoad};
      World world(scene, cpu_options());
      run(world, 50);
      if (share > 1) {  // its far corner creeps below the speed of sticking
        EXPECT_LT(std::abs(rate(world)), 1e-3 / kHalf);
      } else {
        EXPECT_NEAR(rate(world) / ((1 - share) * kLoad / kAboutHinge * 50 * kStep), 1, 0.01);
      }
    }
  }
}

// A motor with a torque gives that, of either sign and however weak; a turn within a step counts as its sine.
TEST_P(AffineDrives, MotorGivesItsTorque) {
  for (const double torque : {0.4, -1e-3}) {
    double inertia = 0;
    Scene scene = flywheel(GetParam(), inertia);
    scene.joints[0].motor = JointMotor{.force = torque};
    World world(scene, cpu_options());
    run(world, 20);
    const double gained = torque / inertia * 20 * kStep;
    const double turn = gained * kStep;
    // implicit_euler loses the square of its turn from the spin of a body in a step.
    EXPECT_NEAR(rate(world) / gained, 1, 1e-6 + 20 * turn * turn) << torque;
  }
}

TEST_P(AffineDrives, MotorGivesItsForce) {
  Scene scene = driven_scene(GetParam());
  add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 2);
  scene.joints.push_back(joint_of(JointKind::slider, kWorldBody, 0, {}, {0, 0, 1}));
  for (const double force : {-7.0, 3.0, 2 * kGravity}) {  // the last one is the weight
    scene.joints[0].motor = JointMotor{.force = force};
    World world(scene, cpu_options());
    run(world, 200);
    EXPECT_NEAR(world.states().velocity[0].z, (force / 2 - kGravity) * 200 * kStep, 1e-6) << force;
  }
  scene.joints[0].motor->damping = 4;  // m v' = F - m g - c v
  scene.gravity = {};
  World damped(scene, cpu_options());
  run(damped, 4000);
  EXPECT_NEAR(damped.states().velocity[0].z, 2 * kGravity / 4, 1e-5);
}

// Along a cylindrical joint and about it, both at once.
TEST_P(AffineDrives, DriveCylindricalJoints) {
  Scene scene = driven_scene(GetParam());
  const double inertia = add_box(scene, {0, 0, 0}, {0.2, 0.2, 0.1}, 2).inertia.z;
  scene.joints.push_back(joint_of(JointKind::cylindrical, kWorldBody, 0, {}, {0, 0, 1}));
  Joint& joint = scene.joints[0];
  const auto spin = [](const World& world) { return world.states().angular_velocity[0].z; };
  const auto height = [](const World& world) { return world.states().position[0].z; };

  joint.motor = JointMotor{.force = 5};
  joint.turn.motor = JointMotor{.force = 0.05};
  World pushed(scene, cpu_options());
  run(pushed, 100);
  EXPECT_NEAR(pushed.states().velocity[0].z, (5.0 / 2 - kGravity) * 100 * kStep, 1e-6);
  EXPECT_NEAR(spin(pushed) / (0.05 / inertia * 100 * kStep), 1, 1e-4);

  joint.limits = {-0.05, 1};
  joint.turn.motor = JointMotor{.speed = 3, .max_force = 2};
  joint.turn.limits = {-1, 1.2};
  World limited(scene, cpu_options());
  run(limited, 1500);
  EXPECT_NEAR(height(limited), -0.05, 1e-5);
  const Vec3d x = rotate(limited.states().orientation[0], {1, 0, 0});
  EXPECT_NEAR(std::atan2(x.y, x.x), 1.2, 1e-4);
  EXPECT_NEAR(spin(limited), 0, 1e-4);

  joint.limits = Joint{}.limits;
  joint.motor.reset();
  joint.turn = {};
  joint.friction = 2 * kGravity * 0.5;
  joint.turn.friction = 0.1;
  scene.bodies[0].angular_velocity = {0, 0, 4};
  World rubs(scene, cpu_options());
  run(rubs, 50);
  EXPECT_NEAR(rubs.states().velocity[0].z, -0.5 * kGravity * 50 * kStep, 1e-3);
  EXPECT_NEAR(spin(rubs) / (4 - 0.1 / inertia * 50 * kStep), 1, 0.01);
}

TEST_P(AffineDrives, FrictionStopsAWheel) {
  double inertia = 0;
  Scene scene = flywheel(GetParam(), inertia);
  scene.joints[0].friction = 0.3;
  scene.bodies[0].angular_velocity = {0, 4, 0};
  World world(scene, cpu_options());
  const double time = 4 * inertia / 0.3;
  const int half = static_cast<int>(time / kStep / 2);
  run(world, half);
  EXPECT_NEAR(rate(world) / (4 - 0.3 / inertia * half * kStep), 1, 0.02);
  run(world, half + 60);
  EXPECT_LT(std::abs(rate(world)), 1e-2);
}

TEST_P(AffineDrives, MotorMovesASlider) {
  Scene scene = driven_scene(GetParam());
  add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 2);
  Joint slider = joint_of(JointKind::slider, 0, kWorldBody, {}, {0, 0, 1});
  slider.motor = JointMotor{.speed = -0.5, .max_force = 100};  // the world goes down from the box
  scene.joints.push_back(slider);
  World up(scene, cpu_options());
  run(up, 200);
  EXPECT_NEAR(up.states().velocity[0].z, 0.5, 1e-3);
  scene.joints[0].motor->max_force = 0.5 * 2 * kGravity;
  World down(scene, cpu_options());
  run(down, 200);
  EXPECT_NEAR(down.states().velocity[0].z, -0.5 * kGravity * 200 * kStep, 1e-6);
}

// Falls on its limit and stays; a motor that pushes against it changes nothing. bdf2 throws back what stops, ever less.
TEST_P(AffineDrives, LimitsHold) {
  constexpr double kLimit = 0.6;
  for (const bool world_first : {true, false}) {
    for (const bool is_pushed : {false, true}) {
      Scene scene = rod_on_hinge(GetParam(), world_first);
      scene.joints[0].limits = {-kLimit, 3};
      if (world_first) scene.joints[0].limits = {-3, kLimit};
      if (is_pushed) {
        const double toward = world_first ? 4 : -4;
        scene.joints[0].motor = JointMotor{.speed = toward, .max_force = 30};
      }
      World world(scene, cpu_options());
      double most = 0;
      for (int k = 0; k < 2500; ++k) {
        ASSERT_TRUE(world.step().converged) << k;
        most = std::max(most, angle(world));
      }
      EXPECT_NEAR(most, kLimit, 1e-3);  // within a step a turn is measured by its sine
      EXPECT_NEAR(angle(world), kLimit, 1e-5);
      EXPECT_NEAR(rate(world), 0, 1e-5);
    }
  }
}

// As stiff as they are, motors that go on do not hold a joint beyond its limit.
TEST_P(AffineDrives, LimitsHoldAgainstMotorsOfTheirJoint) {
  constexpr double kLimit = 0.5, kFar = 2;
  for (const JointMotor& motor :
       {JointMotor{.speed = 2}, JointMotor{.speed = 2, .max_force = 1e9},
        JointMotor{.position = kFar, .stiffness = 1e9, .damping = 1e7},
        JointMotor{.position = kFar, .stiffness = 1e9, .damping = 1e7, .max_force = 1e12}}) {
    for (const JointKind kind : {JointKind::hinge, JointKind::slider}) {
      SCOPED_TRACE(testing::Message() << motor.max_force << ' ' << motor.stiffness << ' '
                                      << (kind == JointKind::hinge ? "hinge" : "slider"));
      double inertia = 0;
      Scene scene = flywheel(GetParam(), inertia);
      scene.joints[0].kind = kind;
      scene.joints[0].limits = {-0.1, kLimit};
      scene.joints[0].motor = motor;
      World world(scene, cpu_options());
      // Where all is at rounding a step may not see that it is done.
      for (int k = 0; k < 200; ++k) ASSERT_LT(world.step().residual_max, 1e-9) << k;
      const double at = kind == JointKind::hinge ? angle(world) : world.states().position[0].y;
      EXPECT_NEAR(at, kLimit, motor.stiffness > 0 ? 1e-4 * (kFar - kLimit) : 1e-6);
    }
  }
}

TEST_P(AffineDrives, ASliderStopsAtItsLimit) {
  Scene scene = driven_scene(GetParam());
  add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 2);
  Joint slider = joint_of(JointKind::slider, kWorldBody, 0, {}, {0, 0, 1});
  slider.limits = {-0.25, 1};
  scene.joints.push_back(slider);
  World world(scene, cpu_options());
  run(world, 2500);
  EXPECT_NEAR(world.states().position[0].z, -0.25, 1e-5);
}

// A position motor with gains is a torsion spring, here by more than a turn, and a damper.
TEST(AffineDrives, PositionMotorSwingsAsASpring) {
  double inertia = 0;
  Scene scene = flywheel(1, inertia);
  constexpr double kStiffness = 0.5, kTarget = 5;
  for (const double ratio : {0.0, 0.2}) {
    const double undamped = std::sqrt(kStiffness / inertia);
    const double c = ratio * 2 * std::sqrt(kStiffness * inertia);
    scene.joints[0].motor = JointMotor{.position = kTarget, .stiffness = kStiffness, .damping = c};
    World world(scene, cpu_options());
    const double damped = undamped * std::sqrt(1 - ratio * ratio);
    double turned = 0, before = 0;
    for (int k = 0; k < 1400; ++k) {
      ASSERT_TRUE(world.step().converged);
      const double now = angle(world);
      turned += std::remainder(now - before, 2 * kPi);
      before = now;
      const double t = world.time();
      const double expected =
          kTarget *
          (1 - std::exp(-ratio * undamped * t) *
                   (std::cos(damped * t) + ratio * undamped / damped * std::sin(damped * t)));
      ASSERT_NEAR(turned, expected, 0.01 * kTarget) << t << ' ' << ratio;
    }
    EXPECT_GT(world.time() * damped, 2 * kPi);
  }
}

// Two wheels on one axle in space: what one gains the other has given.
TEST_P(AffineDrives, AMotorBetweenTwoBodiesKeepsTheirMomentum) {
  Scene scene = driven_scene(GetParam());
  scene.gravity = {};
  const double first = add_box(scene, {0, 0, 0}, {0.2, 0.05, 0.2}, 3).inertia.y;
  const double second = add_box(scene, {0, 0.2, 0}, {0.1, 0.05, 0.1}, 2).inertia.y;
  Joint hinge = joint_of(JointKind::hinge, 0, 1, {0, 0.1, 0}, {0, 1, 0});
  hinge.motor = JointMotor{.speed = 3, .max_force = 0.2};
  scene.joints.push_back(hinge);
  World world(scene, cpu_options());
  StepReport report;
  for (int k = 0; k < 300; ++k) report = world.step();
  EXPECT_NEAR(rate(world, 1) - rate(world, 0), 3, 5e-3);
  // implicit_euler loses the square of its turn from the spin of each body in a step.
  const double lost = GetParam() == 0 ? 300 * (3 * kStep) * (3 * kStep) : 0;
  EXPECT_NEAR((first * rate(world, 0)) / (second * rate(world, 1)), -1, 1e-3 + lost);
  EXPECT_LT(norm(Vec3d{report.own[momentum_x], report.own[momentum_y], report.own[momentum_z]}),
            1e-10);
}

TEST(AffineDrives, ResumedRunsHaveTheSameBits) {
  const Scene scene = driven_pair();
  World one(scene, cpu_options(1));
  run(one, 600);
  const WorldState state = one.save();
  ASSERT_EQ(state.at<double>("affine/joint_position").size(), 2u);
  EXPECT_GT(state.at<double>("affine/joint_position")[0], 7);
  run(one, 100);
  World other(scene, cpu_options(3));
  other.restore(state);
  run(other, 100);
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
  WorldState short_one = state;
  short_one.at<double>("affine/joint_position") = {1};
  EXPECT_THROW(other.restore(short_one), InputError);
}

TEST(AffineJointDrives, AMotorGivesNoMoreThanItsMostInALargeScene) {
  World world(weak_motor_beside_a_large_plate(), cpu_options());
  run(world, 10);
  // The load falls with the cosine of the angle, by less than 1 % here.
  const double about_hinge = 10 * ((1 + 0.01) / 12 + 0.25);
  EXPECT_NEAR(rate(world), 0.1 * (10 * kGravity * 0.5 - 30) / about_hinge, 0.012);
}

/// What a scene is told of its joints.
std::vector<std::string> told_of_joints(const Scene& scene) {
  const World world(scene, cpu_options());
  std::vector<std::string> told;
  for (const std::string& each : world.warnings())
    if (each.starts_with("joints[")) told.push_back(each);
  return told;
}

TEST(AffineJointDrives, JointsThatBeginBeyondTheirLimitsAreTold) {
  for (const JointKind kind : {JointKind::hinge, JointKind::slider}) {
    Scene scene = driven_scene(1);
    add_box(scene, {}, {0.1, 0.1, 0.1}, 1);
    scene.joints = {joint_of(kind, kWorldBody, 0, {}, {1, 0, 0})};
    for (const auto& limits :
         {std::array{-1.0, 1.0}, std::array{0.0, 1.0}, std::array{-1.0, 0.0}}) {
      scene.joints[0].limits = limits;
      EXPECT_THAT(told_of_joints(scene), testing::IsEmpty());
    }
    for (const auto& limits : {std::array{0.5, 1.0}, std::array{-1.0, -0.5}}) {
      scene.joints[0].limits = limits;
      const bool slides = kind == JointKind::slider;
      EXPECT_THAT(told_of_joints(scene),
                  testing::ElementsAre(
                      testing::AllOf(testing::HasSubstr("joints[0]: its bodies began apart"),
                                     testing::HasSubstr(slides ? "0.5 m beyond" : "0.5 rad beyond"),
                                     testing::HasSubstr(slides ? "at 250 m/s" : "at 250 rad/s"))));
    }
  }
}

TEST(AffineJointDrives, MotorsThatCannotMoveAreTold) {
  const auto held = testing::ElementsAre(testing::AllOf(
      testing::HasSubstr("joints["), testing::HasSubstr("they contradict each other")));
  // A slider, alone, with a lock along its axis, and with one across it.
  Scene slider = driven_scene(1);
  add_box(slider, {}, {0.1, 0.1, 0.1}, 1);
  slider.joints = {joint_of(JointKind::slider, kWorldBody, 0, {}, {1, 0, 0})};
  slider.joints[0].motor = JointMotor{.speed = 1};
  EXPECT_THAT(told_of_joints(slider), testing::IsEmpty());
  slider.bodies[0].locks = lock_y;
  EXPECT_THAT(told_of_joints(slider), testing::IsEmpty());
  slider.bodies[0].locks = lock_x;
  EXPECT_THAT(told_of_joints(slider), held);
  slider.joints[0].motor->max_force = 5;
  EXPECT_THAT(told_of_joints(slider), testing::IsEmpty());
  // A hinge, with a lock of the other turns, and with two joints that hold its body otherwise.
  Scene hinge = rod_on_hinge(1);
  hinge.joints[0].motor = JointMotor{.speed = -1};
  EXPECT_THAT(told_of_joints(hinge), testing::IsEmpty());
  hinge.bodies[0].locks = lock_rx | lock_rz;
  EXPECT_THAT(told_of_joints(hinge), testing::IsEmpty());
  hinge.bodies[0].locks = 0;
  hinge.joints.push_back(joint_of(JointKind::fixed, 0, kWorldBody, {1, 0, 0}, {1, 0, 0}));
  EXPECT_THAT(told_of_joints(hinge), held);
  hinge.joints[1].kind = JointKind::ball;
  EXPECT_THAT(told_of_joints(hinge), held);
  // Four rods in a frame turn, until one more joint closes it.
  Scene frame = driven_scene(1);
  const Vec3d corner[] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k) {
    const Vec3d &from = corner[k], &to = corner[k + 1];
    const bool is_flat = k == 1;
    add_box(frame, 0.5 * (from + to) + Vec3d{0, 0.1 * k, 0},
            is_flat ? Vec3d{0.02, 0.02, 0.4} : Vec3d{0.4, 0.02, 0.02}, 1);
  }
  for (int k = 0; k < 4; ++k)
    frame.joints.push_back(joint_of(JointKind::hinge, k == 0 ? kWorldBody : k - 1,
                                    k == 3 ? kWorldBody : k, corner[k], {0, 1, 0}));
  frame.joints[0].motor = JointMotor{.speed = 1};
  EXPECT_THAT(told_of_joints(frame), testing::IsEmpty());
  frame.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 1, {1, 0, 0.5}, {0, 1, 0}));
  EXPECT_THAT(told_of_joints(frame), held);
}

/// Its motor is so stiff that rounding of places decides what its energy is.
TEST(AffineMotors, StepsOfASliderWithAMotorWithoutBoundEndBeforeRounding) {
  Scene scene = affine_scene(kStep, 0, 1);
  scene.gravity = {};
  add_box(scene, {}, {0.05, 0.05, 0.05}, 1);
  Joint slider = joint_of(JointKind::slider, kWorldBody, 0, {}, {1, 0, 0});
  slider.motor = JointMotor{.speed = 1};
  scene.joints = {slider};
  World world(scene, cpu_options());
  for (int k = 0; k < 500; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged) << k;
    ASSERT_LT(report.iterations, 10) << k;
  }
}

TEST(AffineJointDrives, MotorsThatContradictEachOtherAreTold) {
  const auto held = [](const char* more) {
    return testing::ElementsAre(testing::AllOf(testing::HasSubstr("joints[0]: its motor"),
                                               testing::HasSubstr("they contradict each other"),
                                               testing::HasSubstr(more)));
  };
  // Two motors of one axis, whose joint may name its bodies the other way round.
  Scene one = rod_on_hinge(1);
  one.joints.push_back(one.joints[0]);
  std::swap(one.joints[1].bodies[0], one.joints[1].bodies[1]);
  one.joints[0].motor = JointMotor{.speed = 1};
  one.joints[1].motor = JointMotor{.speed = 1};
  EXPECT_THAT(told_of_joints(one), held("and 1 more joints so"));
  one.joints[1].motor->speed = 0;
  EXPECT_THAT(told_of_joints(one), held("and 1 more joints so"));
  one.joints[1].motor->speed = -1;
  EXPECT_THAT(told_of_joints(one), testing::IsEmpty());
  one.joints[1].motor = JointMotor{.speed = 1, .max_force = 1};
  EXPECT_THAT(told_of_joints(one), testing::IsEmpty());
  // Three about one axis: the third follows from the others.
  Scene ring = driven_scene(1);
  add_box(ring, {0, 0, 0}, {0.2, 0.05, 0.2}, 3);
  add_box(ring, {0, 0.2, 0}, {0.1, 0.05, 0.1}, 2);
  for (const auto& bodies :
       {std::array{kWorldBody, 0}, std::array{0, 1}, std::array{kWorldBody, 1}}) {
    ring.joints.push_back(joint_of(JointKind::hinge, bodies[0], bodies[1], {0, 0.1, 0}, {0, 1, 0}));
    ring.joints.back().motor = JointMotor{.speed = 1};
  }
  EXPECT_THAT(told_of_joints(ring), held("and 2 more joints so"));
  ring.joints[2].motor->speed = 2;
  EXPECT_THAT(told_of_joints(ring), testing::IsEmpty());
  // About axes that cross, and along one and about it, motors do not meet.
  Scene both = driven_scene(1);
  add_box(both, {}, {0.1, 0.1, 0.1}, 1);
  both.joints = {joint_of(JointKind::cylindrical, kWorldBody, 0, {}, {1, 0, 0})};
  both.joints[0].motor = JointMotor{.speed = 1};
  both.joints[0].turn.motor = JointMotor{.speed = -2};
  EXPECT_THAT(told_of_joints(both), testing::IsEmpty());
}

}  // namespace
}  // namespace scree::affine
