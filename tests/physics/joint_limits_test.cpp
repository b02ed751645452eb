// Limits and cables hold at the end of a step, also where bodies turn fast: what one solve a step leaves is of third order, and is
// taken away as that of the rows which a joint always holds.

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kLimitStep = 2e-3, kRate = 25;

struct Errors {
  double corrected = 0, once = 0;  ///< largest of all steps [m]; with one solve a step
};

/// Runs a scene with solves until joints end a step in place, and with one solve a step.
/// @param at_end  called with the world that was corrected
template <class AtEnd>
Errors largest_errors(Scene scene, double duration, AtEnd at_end) {
  Errors errors;
  World world = reference_world(scene);
  for (int k = steps_for(scene, duration); k > 0; --k) {
    const StepReport report = world.step();
    EXPECT_TRUE(report.converged);
    errors.corrected = std::max(errors.corrected, report.max_joint_error);
  }
  at_end(world);
  scene.solver.stop = {StopRule::Level::fixed_iterations, 0};
  scene.solver.max_iterations = 2000;
  World once = reference_world(scene);
  for (int k = steps_for(scene, duration); k > 0; --k)
    errors.once = std::max(errors.once, once.step().max_joint_error);
  return errors;
}

/// A hub that turns about z at kRate, and a ball beside it that turns with it.
Scene hub_and_ball() {
  Scene scene = empty_scene(kLimitStep, 0);
  scene.gravity = {};
  BodyDescription& ball = add_sphere(scene, {0.5, 0, 0}, 0.1, 1);
  ball.velocity = {0, 0.5 * kRate, 0};
  ball.angular_velocity = {0, 0, kRate};
  BodyDescription& hub = add_wall_box(scene, {}, {0.05, 0.05, 0.05}, BodyKind::kinematic);
  Motion motion;
  motion.kind = Motion::Kind::rotating;
  motion.rate = kRate;
  hub.motion = motion;
  return scene;
}

// The ball goes out along its guide, is stopped there at 20 m/s and is held by the limit from then on.
TEST(JointLimits, ASliderOnATurningHubEndsStepsAtItsLimit) {
  for (const bool hub_first : {true, false}) {
    Scene scene = hub_and_ball();
    Joint slider = joint_of(JointKind::slider, 1, 0, {0.5, 0, 0}, {1, 0, 0});
    slider.limits = {-0.2, 0.4};
    if (!hub_first) {
      std::swap(slider.bodies[0], slider.bodies[1]);
      slider.limits = {-0.4, 0.2};
    }
    scene.joints.push_back(slider);
    const Errors errors = largest_errors(scene, 0.5, [](const World& world) {
      EXPECT_NEAR(norm(world.states().position[0]), 0.9, 2e-7);
    });
    EXPECT_LT(errors.corrected, 2e-7);
    EXPECT_GT(errors.once, 1e-5);
  }
}

// Two boxes fly apart until the cable between their corners is taut, and tumble at its ends from then on.
TEST(JointLimits, TumblingBoxesStayWithinTheLengthOfTheirCable) {
  Scene scene = empty_scene(kLimitStep, 0);
  scene.gravity = {};
  for (const double side : {-1.0, 1.0}) {
    BodyDescription& box = add_box(scene, {0.4 * side, 0, 0}, {0.2, 0.1, 0.05}, 2);
    box.velocity = {side, 6 * side, 2 * side};
    box.angular_velocity = {15, 10 * side, -20};
  }
  Joint cable = line_of(JointKind::cable, 0, 1, {-0.2, 0.1, 0.05}, {0.2, -0.1, 0.05});
  cable.length = 0.7;
  scene.joints.push_back(cable);
  const Errors errors = largest_errors(
      scene, 1, [](const World& world) { EXPECT_GT(norm(world.joints()[0].force), 0) << "taut"; });
  EXPECT_LT(errors.corrected, 2e-7);
  EXPECT_GT(errors.once, 1e-5);
}

// Two long boxes tumble through empty space, and close like the blades of a knife until their hinge stops them.
TEST(JointLimits, AHingeOfTumblingBodiesEndsStepsAtItsLimit) {
  Scene scene = empty_scene(kLimitStep, 0);
  scene.gravity = {};
  for (const double side : {-1.0, 1.0}) {
    BodyDescription& box = add_box(scene, {0.4 * side, 0, 0}, {0.4, 0.1, 0.05}, 2);
    box.angular_velocity = {7, 4 + 15 * side, -9};
    box.velocity = cross(box.angular_velocity, box.position);
  }
  Joint hinge = joint_of(JointKind::hinge, 0, 1, {}, {0, 1, 0});
  hinge.limits = {-0.2, 0.3};
  scene.joints.push_back(hinge);
  const Errors errors = largest_errors(
      scene, 1, [](const World& world) { EXPECT_LT(world.joints()[0].position, 0.3 + 1e-6); });
  EXPECT_LT(errors.corrected, 2e-7);
  EXPECT_GT(errors.once, 1e-5);
}

// A wheel turns by 4 rad in a step, more than half a turn, and is stopped after 25 steps where it has turned by 100 rad, either way.
TEST(JointLimits, AFastWheelStopsAfterItsTurns) {
  for (const bool wheel_first : {true, false}) {
    for (const double way : {1.0, -1.0}) {
      Scene scene = empty_scene(0.01, 0);
      scene.gravity = {};
      add_box(scene, {}, {0.1, 0.1, 0.05}, 2).angular_velocity = {0, 0, 400 * way};
      Joint axle = joint_of(JointKind::hinge, kWorldBody, 0, {});
      if (wheel_first) std::swap(axle.bodies[0], axle.bodies[1]);
      const double sign = wheel_first ? -way : way;
      axle.limits = sign > 0 ? std::array{-50.0, 100.0} : std::array{-100.0, 50.0};
      scene.joints.push_back(axle);
      World world = reference_world(scene);
      const WorldState start = world.save();
      for (int k = 0; k < 24; ++k) world.step();
      EXPECT_NEAR(world.states().angular_velocity[0].z, 400 * way, 1e-9);
      const WorldState running = world.save();
      for (int k = 0; k < 10; ++k) world.step();
      EXPECT_NEAR(world.states().angular_velocity[0].z, 0, 1e-9);
      EXPECT_NEAR(world.joints()[0].position, 100 * sign, 1e-6);
      for (const WorldState* state : {&start, &running}) {
        world.restore(*state);
        while (world.steps_done() < 34) world.step();
        EXPECT_NEAR(world.joints()[0].position, 100 * sign, 1e-6);
      }
    }
  }
}

// A limit that a joint does not reach changes nothing but roundings.
TEST(JointLimits, ALimitOutOfReachIsNotFelt) {
  Scene free = hub_and_ball();
  free.joints.push_back(joint_of(JointKind::slider, 1, 0, {0.5, 0, 0}, {1, 0, 0}));
  World world = reference_world(free);
  Scene scene = free;
  scene.joints[0].limits = {-100, 100};
  World limited = reference_world(scene);
  for (int k = 0; k < 50; ++k) {
    world.step();
    limited.step();
    EXPECT_LT(norm(world.states().position[0] - limited.states().position[0]), 1e-9);
  }
}

}  // namespace
}  // namespace scree::physics
