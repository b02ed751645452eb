// Sliding that turns into rolling, and the friction moments that stop rolling and spinning.

#include <gtest/gtest.h>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

class Rolling : public ::testing::TestWithParam<Model> {};
std::string rolling_model_name(const ::testing::TestParamInfo<Model>& info) {
  return name_of(info.param);
}
INSTANTIATE_TEST_SUITE_P(SingleBody, Rolling, ::testing::Values(Model::convex, Model::exact),
                         rolling_model_name);

// The residual of a contact that slides falls with its friction, however far its bodies are into each other. Levels know that.
TEST_P(Rolling, AFloorOfAnyFrictionHolds) {
  for (const double mu : {10.0, 1e3, 1e5, 1e6}) {
    Scene scene = empty_scene(1e-3, mu, GetParam());
    scene.solver.stop = {};  // quality
    add_plane(scene);
    add_sphere(scene, {0, 0, 0.05}, 0.05, 1).velocity = {1, 0, 0};
    World world = reference_world(scene);
    for (int k = 0; k < 500; ++k) world.step();
    const BodyStates s = world.states();
    EXPECT_NEAR(s.position[1].z, 0.05, 1e-3 * 0.05) << mu;
    EXPECT_NEAR(s.velocity[1].x, 5.0 / 7, 1e-3) << mu;
  }
}

/// A ball and a box on a slope after 500 steps in float.
BodyStates states_on_a_slope(double degrees, double size, Model model) {
  const double time = std::sqrt(size), r = 0.1 * size;
  Scene scene = empty_scene(1e-3 * time, 0.5, model);
  solve_to(scene, 1e-6 * kGravity * time);
  tilt(scene, degrees);
  add_plane(scene);
  const double mass = 1000 * 4.0 / 3 * kPi * r * r * r;
  add_sphere(scene, {0, 0, r}, r, mass);
  add_box(scene, {0, size, r}, {r, r, r}, mass);
  World world(scene, cpu_options(1, Precision::single_precision));
  for (int k = 0; k < 500; ++k) EXPECT_TRUE(world.step().converged) << size;
  return world.states();
}

// Squares of the impulses of dust and of mountains are no floats.
TEST_P(Rolling, BodiesOfAnySizeRollStickAndSlideInFloat) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    const double gained = kGravity * 0.5 * std::sqrt(size), slope = radians(17);
    const BodyStates s = states_on_a_slope(17, size, GetParam());
    EXPECT_NEAR(s.velocity[1].x, 5.0 / 7 * std::sin(slope) * gained, 1e-3 * gained) << size;
    EXPECT_NEAR(s.position[2].x, 0, 1e-4 * size) << size;
    const double steep = radians(35);
    EXPECT_NEAR(states_on_a_slope(35, size, GetParam()).velocity[2].x,
                (std::sin(steep) - 0.5 * std::cos(steep)) * gained, 0.01 * gained)
        << size;
  }
}

TEST_P(Rolling, A15_SlideTurnsIntoRolling) {
  const double v0 = 2, mu = 0.2, r = 1;
  Scene scene = empty_scene(1e-3, mu, GetParam());
  add_plane(scene);
  add_sphere(scene, {0, 0, r}, r, 1).velocity = {v0, 0, 0};
  World world = reference_world(scene);
  const double expected_time = 2 * v0 / (7 * mu * kGravity);
  double time = -1, x = 0;
  for (int k = 0; k < 600; ++k) {
    world.step();
    const BodyStates s = world.states();
    const double slip = s.velocity[1].x - r * s.angular_velocity[1].y;
    if (time < 0 && slip < 1e-6) {
      time = world.time();
      x = s.position[1].x;
    }
  }
  const BodyStates s = world.states();
  EXPECT_NEAR(s.velocity[1].x, 5.0 / 7 * v0, 1e-4);
  EXPECT_NEAR(r * s.angular_velocity[1].y, 5.0 / 7 * v0, 1e-4);
  if (GetParam() == Model::exact) {  // the convex sphere hops first, and rolls later
    EXPECT_NEAR(expected_time, 0.29125, 5e-6);
    EXPECT_NEAR(time, expected_time, 2e-3);
    EXPECT_NEAR(x, 12 * v0 * v0 / (49 * mu * kGravity), 2e-3 * v0);
  }
}

TEST_P(Rolling, A16_SpinFrictionStopsASpinningSphere) {
  const double r = 0.1, sigma = 1e-3;
  Scene scene = empty_scene(1e-3, 0.5, GetParam());
  scene.materials[0].spinning_friction = sigma;
  add_plane(scene);
  add_sphere(scene, {0, 0, r}, r, 1).angular_velocity = {0, 0, 10};
  World world = reference_world(scene);
  const double rate = 2.5 * sigma * kGravity / (r * r);
  EXPECT_NEAR(rate, 2.4525, 1e-9);
  double stop = -1;
  for (int k = 0; k < 4200; ++k) {
    world.step();
    const double w = world.states().angular_velocity[1].z;
    if (k + 1 == 2000) {
      EXPECT_NEAR((10 - w) / 2, rate, 0.005 * rate);
    }
    if (stop < 0 && std::abs(w) < 1e-8) stop = world.time();
  }
  EXPECT_NEAR(stop, 10 / rate, 0.005 * 10 / rate);
}

/// Rolling along +x at speed v0 with rolling friction 5e-4 m; body 1.
Scene rolling_scene(double v0, double degrees, Model model) {
  Scene scene = empty_scene(5e-3, 0.5, model);
  tilt(scene, degrees);
  scene.materials[0].rolling_friction = 5e-4;
  add_plane(scene);
  BodyDescription& ball = add_sphere(scene, {0, 0, 0.05}, 0.05, 1);
  ball.velocity = {v0, 0, 0};
  ball.angular_velocity = {0, v0 / 0.05, 0};
  return scene;
}

TEST_P(Rolling, A18_RollingFrictionStopsARollingSphere) {
  const Scene scene = rolling_scene(1, 0, GetParam());
  World world = reference_world(scene);
  double stop = -1;
  const int steps = steps_for(scene, 15);
  for (int k = 0; k < steps; ++k) {
    world.step();
    if (stop < 0 && world.states().velocity[1].x < 1e-8) stop = world.time();
  }
  EXPECT_NEAR(stop, 14.271, 0.01 * 14.271);
  EXPECT_NEAR(world.states().position[1].x, 7.1356, 0.01 * 7.1356);
}

TEST_P(Rolling, A18_RestsOnAnInclineUpToTheRollingAngle) {
  const double limit = 5e-4 / 0.05;  // tan of the steepest incline
  for (const double share : {0.99, 1.01}) {
    const Scene scene = rolling_scene(0, std::atan(share * limit) / kPi * 180, GetParam());
    World world = reference_world(scene);
    run_for(world, scene, 2);
    const double x = world.states().position[1].x;
    const double a = 5.0 / 7 * kGravity * 0.01 * limit;  // just past the limit
    if (share < 1) {
      EXPECT_LT(std::abs(x), 1e-6);
    }
    if (share > 1) {
      EXPECT_GT(x, 0.5 * a * 2);
    }
  }
}

}  // namespace
}  // namespace scree::physics
