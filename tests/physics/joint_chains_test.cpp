// Long chains and nets of joints: their held rows are solved all at once, so steps need no iteration while nothing else acts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/hanging_scenes.h"
#include "tests/physics/long_tests.h"

namespace scree::physics {
namespace {

// With the stop level that runs have by default.
TEST(JointChains, AThousandLinksHangWithoutIterations) {
  const Scene scene = hanging_chain(1000);
  World world = reference_world(scene);
  double error = 0;
  int iterations = 0;
  for (int k = 0; k < 500; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged) << k;
    error = std::max(error, report.max_joint_error);
    iterations += report.iterations;
  }
  EXPECT_LT(error, 1e-6);
  EXPECT_EQ(iterations, 0);
  // It swings down as it must: the middle has fallen.
  EXPECT_LT(world.states().position[500].z, scene.bodies[500].position.z - 1e-3);
}

TEST(JointChains, ANetOf32By32KnotsHoldsAndFallsWithItsMiddle) {
  const Scene scene = hanging_net(32);
  World world = reference_world(scene);
  double error = 0;
  for (int k = 0; k < 400; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged) << k;
    error = std::max(error, report.max_joint_error);
  }
  EXPECT_LT(error, 1e-6);
  EXPECT_LT(world.states().position[16 * 32 + 16].z, -0.02);
}

/// Largest joint error of a run [m].
double largest_error(const Scene& scene, double duration) {
  World world(scene, cpu_options(2));
  double error = 0;
  world.run(duration, [&](const StepReport& report) {
    EXPECT_TRUE(report.converged) << report.step;
    error = std::max(error, report.max_joint_error);
    return error < 1;
  });
  return error;
}

TEST(JointChains, AThousandLinksHoldForTenSeconds) {
  if (!runs_long_tests()) GTEST_SKIP() << kLongTest;
  EXPECT_LT(largest_error(hanging_chain(1000), 10), 1e-6);
}

TEST(JointChains, ANetOf32By32KnotsHoldsForTenSeconds) {
  if (!runs_long_tests()) GTEST_SKIP() << kLongTest;
  EXPECT_LT(largest_error(hanging_net(32), 10), 1e-6);
}

// Between hooks 1 m apart a chain of 1.2 m has the form y = a cosh(x / a) with 2 a sinh(1 / 2 a) = 1.2 m.
TEST(JointChains, AHangingChainIsACatenary) {
  constexpr int kLinks = 50;
  constexpr double kParameter = 0.469542, kSag = 0.292344, kLength = 1.2, kMass = 0.01;
  Scene scene = empty_scene(1e-3, 0);
  scene.solver.stop = StopRule();
  // Equal links from one hook to the other on a polygon that is not the catenary: an arc of the same length.
  double low = 0.1, high = kPi;
  for (int k = 0; k < 100; ++k) {  // the arc of 1.2 m over a chord of 1 m
    const double half = 0.5 * (low + high);
    (std::sin(half) / half * kLength > 1 ? low : high) = half;
  }
  const double link = 2 * (0.5 * kLength / low) * std::sin(low / kLinks);
  Vec3d end{-0.5, 0, 0};
  for (int k = 0; k < kLinks; ++k) {
    const double slope = low * (1 - (2 * k + 1.0) / kLinks);
    const Vec3d next = end + link * Vec3d{std::cos(slope), 0, -std::sin(slope)};
    add_box(scene, 0.5 * (end + next), {link / 2, 0.002, 0.002}, kMass).orientation =
        exp_map(Vec3d{0, slope, 0});
    scene.joints.push_back(joint_of(JointKind::ball, k == 0 ? kWorldBody : k - 1, k, end));
    end = next;
  }
  scene.joints.push_back(joint_of(JointKind::ball, kLinks - 1, kWorldBody, end));
  World world = reference_world(scene);
  // It swings for ever; drag brings it to rest.
  for (int k = 0; k < 3000; ++k) {
    const BodyStates s = world.states();
    for (int i = 0; i < kLinks; ++i) {
      const auto body = static_cast<std::size_t>(i);
      world.apply_force(i, -0.05 * s.velocity[body], -2e-6 * s.angular_velocity[body]);
    }
    ASSERT_TRUE(world.step().converged) << k;
  }
  const BodyStates s = world.states();
  double lowest = 0;
  for (std::size_t i = 0; i < kLinks; ++i) lowest = std::min(lowest, s.position[i].z);
  EXPECT_NEAR(-lowest, kSag, 0.02 * kSag);
  // The hooks share the weight; along the chord they pull by its weight per length times the parameter.
  const Vec3d pull = 1e3 * world.joints()[0].force;
  EXPECT_NEAR(std::abs(pull.z), kLinks * kMass * kGravity / 2, 0.01 * kLinks * kMass * kGravity);
  const double along = kLinks * kMass * kGravity / kLength * kParameter;
  EXPECT_NEAR(std::abs(pull.x), along, 0.02 * along);
}

TEST(JointChains, HaveTheSameBitsOnAnyNumberOfThreads) {
  expect_same_bits_on_threads(hanging_net(8), 100);
}

// A rod on three collinear points of the world: two hold it, the third adds nothing. Its impulses are not defined, its rest is.
TEST(JointChains, JointsThatOthersMakeSuperfluousDoNoHarm) {
  Scene scene = empty_scene(1e-3, 0);
  scene.solver.stop = StopRule();
  add_box(scene, {}, {0.5, 0.05, 0.05}, 1);
  for (const double x : {-0.5, 0.0, 0.5})
    scene.joints.push_back(joint_of(JointKind::ball, kWorldBody, 0, {x, 0, 0}));
  World world = reference_world(scene);
  for (int k = 0; k < 200; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged);
    ASSERT_EQ(report.iterations, 0);
  }
  EXPECT_LT(norm(world.states().position[0]), 1e-9);
  Vec3d force;
  for (const JointRecord& joint : world.joints()) {
    force += 1e3 * joint.force;
    EXPECT_LT(norm(joint.force), 0.1);
  }
  EXPECT_LT(norm(force - Vec3d{0, 0, kGravity}), 1e-5);
}

}  // namespace
}  // namespace scree::physics
