// Bodies whose motion is prescribed: how they push, where they wait, and how far they turn.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "dynamics/affine/affine_card.h"
#include "host/error.h"
#include "host/state_hash.h"
#include "tests/dynamics/affine_scenes.h"

namespace scree::affine {
namespace {

using namespace test;
using physics::add_box;
using testing::AllOf;
using testing::HasSubstr;

/// A cube of steel that nothing holds, before one that is led toward it.
Scene pushed_cube(double time_step, double speed, double half = 0.05) {
  Scene scene = affine_scene(time_step, 0.3, 1);
  scene.gravity = {};
  add_pusher(scene, {}, {half, half, half}, {speed, 0, 0});
  add_box(scene, {3.1 * half, 0, 0}, {half, half, half}, 64e3 * half * half * half);
  return scene;
}

// Inertia alone squeezes them by more than the limit where they are to be as fast within a step. With the fastest one that
// limits what they gain in a step to some four hundredth of the speed.
TEST(AffineLedBodies, PushWhatNothingHoldsUpToTheirSpeed) {
  struct Case {
    double time_step, speed, half;
    int steps;
  };
  for (const Case& each :
       {Case{1e-3, 10, 0.05, 60}, Case{2e-4, 10, 0.05, 300}, Case{1e-3, 30, 0.05, 100},
        Case{0.01, 10, 1.5, 120}, Case{2e-4, 100, 0.05, 900}}) {
    SCOPED_TRACE(testing::Message() << each.time_step << " s, " << each.speed << " m/s");
    World world(pushed_cube(each.time_step, each.speed, each.half), cpu_options());
    double fastest = 0;
    int slow = 0;
    for (int k = 0; k < each.steps; ++k) {
      const double before = world.states().position[0].x;
      const StepReport report = world.step();
      ASSERT_LE(report.own[max_strain], 0.0101) << k;
      const BodyStates states = world.states();
      const double way = states.position[0].x - before;
      ASSERT_GT(states.position[1].x - states.position[0].x, 1.98 * each.half) << k;
      ASSERT_EQ(report.own[blocked] > 0, way < 9e-4 * each.speed * each.time_step) << k;
      slow = way < 0.99 * each.speed * each.time_step ? slow + 1 : slow;
      fastest = std::max(fastest, states.velocity[1].x);
    }
    const BodyStates end = world.states();
    EXPECT_GT(slow, 0);  // else this shows nothing
    EXPECT_NEAR(end.velocity[0].x, each.speed, 1e-3 * each.speed);
    EXPECT_GE(end.velocity[1].x, 0.99 * each.speed);
    EXPECT_LT(fastest, 2 * each.speed);
    EXPECT_THAT(world.warnings(), testing::Contains(HasSubstr("kinematic bodies")));
  }
}

TEST(AffineLedBodies, ResumedRunsHaveTheSameBitsWhereTheyGoPartsOfSteps) {
  const Scene scene = pushed_cube(1e-3, 30);
  World one(scene, cpu_options(1));
  WorldState state;
  int steps = 0;
  do {
    one.step();
    state = one.save();
  } while (state.at<double>("affine/led_part")[0] == 1 && ++steps < 100);
  ASSERT_LT(state.at<double>("affine/led_part")[0], 1);
  World other(scene, cpu_options(2));
  other.restore(state);
  for (int k = 0; k < 20; ++k) one.step(), other.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
  state.at<double>("affine/led_part")[0] = 2;
  EXPECT_THROW(other.restore(state), InputError);
}

// A box that falls along a slider stops a pusher until it is below it. Then the motion goes on as far as it should, and back.
TEST(AffineLedBodies, GoOnLaterFromWhereTheyWereBlocked) {
  Scene scene = affine_scene(0.005, 0, 0);
  add_box(scene, {0.255, 0, 0}, {0.1, 0.1, 0.1}, 8);
  Joint slider;
  slider.kind = JointKind::slider;
  slider.bodies = {kWorldBody, 0};
  slider.axis = {0, 0, 1};
  slider.anchor = scene.bodies[0].position;
  scene.joints.push_back(slider);
  Motion motion;
  motion.kind = Motion::Kind::sampled;
  motion.times = {0, 0.1, 0.2};
  motion.positions = {{}, {0.1, 0, 0}, {}};
  physics::add_wall_box(scene, {}, {0.1, 0.1, 0.1}, BodyKind::kinematic).motion = motion;
  World world(scene, cpu_options());
  int waited = 0;
  double farthest = 0, before = 0;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = world.step();
    ASSERT_LT(report.own[max_strain], 0.02) << k;
    farthest = std::max(farthest, world.states().position[1].x);
    if (!(report.own[blocked] > 0)) continue;
    ++waited;
    before = farthest;
  }
  EXPECT_GT(waited, 10);
  EXPECT_NEAR(before, 0.055, 2e-3);
  EXPECT_NEAR(farthest, 0.1, 5e-3);  // a step ends 5 mm before it at most
  EXPECT_NEAR(world.states().position[1].x, 0, 1e-6);
  EXPECT_LT(world.states().position[0].z, -0.5);
}

/// A rod that turns about its middle, far from a cube.
Scene spinner(double time_step, double rate) {
  Scene scene = affine_scene(time_step, 0.3, 1);
  scene.gravity = {};
  Motion motion;
  motion.kind = Motion::Kind::rotating;
  motion.axis = {0.6, 0, 0.8};
  motion.rate = rate;
  physics::add_wall_box(scene, {}, {0.5, 0.05, 0.05}, BodyKind::kinematic).motion = motion;
  add_box(scene, {6, 6, 0}, {0.05, 0.05, 0.05}, 1);
  return scene;
}

// The chord of a turn is shorter by a sine.
TEST(AffineLedBodies, HaveTheAngularVelocityOfTheirMotion) {
  World world(spinner(0.01, 90), cpu_options());
  EXPECT_LT(norm(world.states().angular_velocity[0] - Vec3d{54, 0, 72}), 1e-6);
  WorldState state;
  for (int k = 0; k < 10; ++k) {
    const StepReport report = world.step();
    EXPECT_LT(norm(world.states().angular_velocity[0] - Vec3d{54, 0, 72}), 1e-6) << k;
    EXPECT_NEAR(report.max_turn, 0.9, 1e-8);
    EXPECT_EQ(report.own[blocked], 0);
    if (k == 4) state = world.save();
  }
  World other(spinner(0.01, 90), cpu_options());
  other.restore(state);
  EXPECT_LT(norm(other.states().angular_velocity[0] - Vec3d{54, 0, 72}), 1e-6);
}

TEST(AffineLedBodies, HaveTheVelocityOfTheirMotionBeforeTheFirstStep) {
  Scene scene = affine_scene(0.01, 0);
  add_pusher(scene, {}, {0.1, 0.1, 0.1}, {0.5, -1, 2});
  add_box(scene, {3, 0, 0}, {0.1, 0.1, 0.1}, 1);
  World world(scene, cpu_options());
  EXPECT_LT(norm(world.states().velocity[0] - Vec3d{0.5, -1, 2}), 1e-9);
}

TEST(AffineLedBodies, TurnInPartsWhereAllowed) {
  Scene scene = spinner(0.01, 250);
  scene.dynamics.parameters["max_turn"] = 0.2;
  World world(scene, cpu_options());
  for (int k = 1; k <= 20; ++k) {
    const StepReport report = world.step();
    EXPECT_EQ(report.own[kPartsColumn], 16) << k;
    EXPECT_NEAR(report.max_turn, 2.5 / 16, 1e-8);
    EXPECT_EQ(report.own[blocked], 0);
  }
  EXPECT_LT(norm(world.states().angular_velocity[0] - Vec3d{150, 0, 200}), 1e-5);
  const Quatd expected = exp_map(50.0 * Vec3d{0.6, 0, 0.8}), found = world.states().orientation[0];
  EXPECT_LT(norm((found * conjugate(expected)).vec()), 1e-6);
  scene.dynamics.parameters["max_turn"] = 4;  // a kinematic body turns by one at most
  EXPECT_EQ(World(scene, cpu_options()).step().own[kPartsColumn], 4);
}

std::string refusal(const Scene& scene) {
  try {
    const World world(scene, cpu_options());
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

// From pose to pose they go straight in their coordinates: half a turn would make them flat.
TEST(AffineLedBodies, AreRefusedWhereTheyTurnTooFarInAStep) {
  Scene scene = spinner(0.01, 99);
  EXPECT_EQ(refusal(scene), "nothing");
  scene = spinner(0.01, -250);
  scene.body_names["drum"] = 0;
  EXPECT_THAT(
      refusal(scene),
      AllOf(HasSubstr("motion.rate: -250 is not allowed: must turn body 0 \"drum\" by 1 rad "
                      "at most in a time step of 0.01 s, which turns it by 2.5 rad"),
            HasSubstr("a time step of 0.00396 s at most, or \"max_turn\"")));
  Motion turning;
  turning.kind = Motion::Kind::linear;
  turning.angular_velocity = {0, 101, 0};
  scene.bodies[0].motion = turning;
  EXPECT_THAT(refusal(scene), HasSubstr("body 0.motion.angular_velocity: [0, 101, 0]"));
  Motion sampled;
  sampled.kind = Motion::Kind::sampled;
  sampled.times = {0, 0.1, 0.11, 0.2};
  sampled.positions.resize(4);
  sampled.orientations = {{}, {}, exp_map(Vec3d{0, 0, 1.2}), exp_map(Vec3d{0, 0, 1.3})};
  scene.bodies[0].motion = sampled;
  EXPECT_THAT(refusal(scene),
              AllOf(HasSubstr("motion.orientations[1]"), HasSubstr("1.2 rad within a time step")));
  sampled.orientations[2] = exp_map(Vec3d{0, 0, 0.9});
  scene.bodies[0].motion = sampled;
  EXPECT_EQ(refusal(scene), "nothing");
}

}  // namespace
}  // namespace scree::affine
