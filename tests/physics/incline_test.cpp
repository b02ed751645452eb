// A block or a round body on an incline: when it starts to move, and how fast it then goes.

#include <gtest/gtest.h>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

class Incline : public ::testing::TestWithParam<Model> {};
std::string model_name(const ::testing::TestParamInfo<Model>& info) { return name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(SingleBody, Incline, ::testing::Values(Model::convex, Model::exact),
                         model_name);

/// Cube of 0.1 m and 1 kg at rest on the incline; body 1.
Scene cube_scene(double degrees, double friction, Model model) {
  Scene scene = empty_scene(1e-3, friction, model);
  tilt(scene, degrees);
  scene.stepping.envelope = 1e-2;
  add_plane(scene);
  add_box(scene, {0, 0, 0.05}, {0.05, 0.05, 0.05}, 1);
  return scene;
}

TEST_P(Incline, A10_CubeSticksBelowTheFrictionAngle) {
  const Scene scene = cube_scene(26, 0.5, GetParam());
  World world = reference_world(scene);
  for (int k = 0; k < 2000; ++k) EXPECT_TRUE(world.step().converged) << "step " << k;
  EXPECT_LT(norm(world.states().position[1] - Vec3d{0, 0, 0.05}), 1e-6);
}

TEST_P(Incline, A10_CubeSlidesAboveTheFrictionAngle) {
  const Scene scene = cube_scene(27, 0.5, GetParam());
  World world = reference_world(scene);
  for (int k = 0; k < 2000; ++k) EXPECT_TRUE(world.step().converged) << "step " << k;
  const double angle = radians(27);
  const double a = kGravity * (std::sin(angle) - 0.5 * std::cos(angle));
  EXPECT_NEAR(a, 0.08326, 5e-6);
  EXPECT_NEAR(world.states().velocity[1].x / 2, a, 0.01 * a);
}

TEST_P(Incline, A11_CubeSlidesWithConstantAcceleration) {
  const Scene scene = cube_scene(40, 0.5, GetParam());
  const double h = scene.stepping.time_step;
  const double angle = radians(40);
  const double a = kGravity * (std::sin(angle) - 0.5 * std::cos(angle));
  EXPECT_NEAR(a, 2.5483, 5e-5);
  World world = reference_world(scene);
  double worst_v = 0, worst_x = 0;
  for (int k = 1; k <= 1000; ++k) {
    EXPECT_TRUE(world.step().converged) << "step " << k;
    const BodyStates s = world.states();
    worst_v = std::max(worst_v, std::abs(s.velocity[1].x - a * k * h));
    worst_x = std::max(worst_x, std::abs(s.position[1].x - a * h * h * k * (k + 1.0) / 2));
  }
  if (GetParam() == Model::exact) {
    EXPECT_LT(worst_v, 1e-6);
    EXPECT_LT(worst_x, 1e-6);
  } else {
    EXPECT_NEAR(world.states().velocity[1].x, a, 0.005 * a);
  }
}

/// Block of width 0.1 and height 0.2 m: b/H = 0.5, tips at 26.565 degrees.
struct BlockEnd {
  double shift = 0;  ///< of the center, downhill [m]
  double angle = 0;  ///< turned by [rad]
};
BlockEnd block_after_one_second(double degrees, double friction, Model model) {
  Scene scene = empty_scene(1e-3, friction, model);
  tilt(scene, degrees);
  scene.stepping.envelope = 1e-2;
  add_plane(scene);
  add_box(scene, {0, 0, 0.1}, {0.05, 0.05, 0.1}, 1);
  World world = reference_world(scene);
  run_for(world, scene, 1);
  const BodyStates s = world.states();
  return {s.position[1].x, rotation_angle(s.orientation[1])};
}

TEST_P(Incline, A12_BlockTipsWhereTheFrictionHolds) {
  const double tipping = std::atan(0.5) / kPi * 180;
  const BlockEnd stays = block_after_one_second(tipping - 0.2, 0.55, GetParam());
  EXPECT_LT(stays.angle, 1e-4);
  EXPECT_LT(std::abs(stays.shift), 1e-4);
  const BlockEnd tips = block_after_one_second(tipping + 0.2, 0.55, GetParam());
  EXPECT_GT(tips.angle, 0.05);  // the moment left over turns it by at least 0.11 rad
}

TEST_P(Incline, A12_BlockSlidesWhereTheFrictionGivesWay) {
  const double sliding = std::atan(0.45) / kPi * 180;
  const BlockEnd stays = block_after_one_second(sliding - 0.2, 0.45, GetParam());
  EXPECT_LT(std::abs(stays.shift), 1e-6);
  const BlockEnd slides = block_after_one_second(sliding + 0.2, 0.45, GetParam());
  EXPECT_LT(slides.angle, 1e-3);
  const double angle = radians(sliding + 0.2);
  const double a = kGravity * (std::sin(angle) - 0.45 * std::cos(angle));
  EXPECT_GT(slides.shift, 0.9 * a / 2);
}

/// Round body with moment k m r^2: a solid sphere has k = 2/5, a cylinder 1/2, a hoop 1.
Scene round_scene(double degrees, double friction, double k, Model model) {
  Scene scene = empty_scene(1e-3, friction, model);
  tilt(scene, degrees);
  scene.stepping.envelope = 1e-2;
  add_plane(scene);
  const double r = 0.05;
  add_sphere(scene, {0, 0, r}, r, 1).inertia = k * r * r * Vec3d{1, 1, 1};
  return scene;
}

TEST_P(Incline, A13_RollsWithoutSlip) {
  for (const double k : {0.4, 0.5, 1.0}) {
    const Scene scene = round_scene(20, 0.3, k, GetParam());
    World world = reference_world(scene);
    run_for(world, scene, 1);
    const BodyStates s = world.states();
    const double a = kGravity * std::sin(radians(20)) / (1 + k);
    EXPECT_NEAR(s.velocity[1].x, a, 0.002 * a) << "k = " << k;
    EXPECT_NEAR(s.angular_velocity[1].y * 0.05, s.velocity[1].x, 1e-6) << "k = " << k;
  }
  EXPECT_NEAR(kGravity * std::sin(radians(20)) / 1.4, 2.3966, 5e-5);
}

TEST_P(Incline, A13_SlipsWhenTheFrictionIsTooSmall) {
  for (const double k : {0.4, 0.5, 1.0}) {
    const double needed = std::tan(radians(20)) / (1 + 1 / k);  // mu at which the slip starts
    for (const double share : {0.98, 1.02}) {
      const Scene scene = round_scene(20, share * needed, k, GetParam());
      World world = reference_world(scene);
      run_for(world, scene, 0.5);
      const BodyStates s = world.states();
      const double slip = s.velocity[1].x - 0.05 * s.angular_velocity[1].y;
      if (share > 1) {
        EXPECT_LT(std::abs(slip), 1e-6) << "k = " << k;
      }
      if (share < 1) {
        EXPECT_GT(slip, 1e-3) << "k = " << k;
      }
    }
  }
}

TEST_P(Incline, A14_RollsWithSlip) {
  const Scene scene = round_scene(60, 0.3, 0.4, GetParam());
  World world = reference_world(scene);
  run_for(world, scene, 1);
  const BodyStates s = world.states();
  const double angle = radians(60);
  const double a = kGravity * (std::sin(angle) - 0.3 * std::cos(angle));
  const double alpha = 5 * 0.3 * kGravity * std::cos(angle) / (2 * 0.05);
  EXPECT_NEAR(a, 7.0242, 5e-5);
  EXPECT_NEAR(s.velocity[1].x, a, 0.002 * a);
  EXPECT_NEAR(s.angular_velocity[1].y, alpha, 0.002 * alpha);
}

}  // namespace
}  // namespace scree::physics
