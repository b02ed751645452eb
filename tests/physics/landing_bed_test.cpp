// Coulomb's law itself while a bed of grains lands, with the settings of a scene that says nothing
// of its solver: steps end at the residual asked for, whatever the friction is. And bodies that land while they slide.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "host/scene/bed_scene.h"
#include "tests/physics/floors.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// In the first half the grains gather speed, in the second they meet. With high friction
/// single steps may end above the tolerance: grains in the edges of the box jam where
/// they overlap both walls.
TEST(LandingBed, ExactStepsConvergeAtAnyFriction) {
  constexpr int kSteps = 30;
  for (const double mu : {1.0, 2.0, 5.0, 10.0}) {
    const std::string friction = "materials.grain.friction=" + std::to_string(mu);
    World world(bed_scene({.count = 1000, .layers = 10}, {"solver.model=exact", friction}),
                cpu_options(1, Precision::single_precision));
    int converged = 0;
    double passes = 0, worst = 0;
    for (int k = 0; k < kSteps; ++k) {
      const StepReport report = world.step();
      converged += report.converged;
      passes += report.applications;
      worst = std::max(worst, report.exact_residual_rms);
    }
    passes /= kSteps;
    EXPECT_GE(converged, 27) << mu << ": " << passes << " passes, residual " << worst << " m/s";
    EXPECT_LT(passes, 2000) << mu;
  }
}

class SlidingLanding : public ::testing::TestWithParam<Floor> {};
INSTANTIATE_TEST_SUITE_P(On, SlidingLanding,
                         ::testing::Values(Floor::plane, Floor::box, Floor::mesh, Floor::hull));

// Convex friction holds a body that slides h mu |u_t| above the ground. One that comes to be listed below that height is
// thrown up to it: with these numbers at up to 1.8 m/s, where it lands with 0.2.
TEST_P(SlidingLanding, DoesNotBounce) {
  constexpr double kSpeed = 10, kFriction = 0.5, kRadius = 0.1;
  for (const double h : {2e-3, 1e-3, 5e-4}) {
    for (const bool is_box : {false, true}) {
      for (const double height : {0.0121, 0.0128, 0.0134}) {
        Scene scene = empty_scene(h, kFriction);
        scene.gravity = {0, 0, -kGravity};
        add_floor(scene, GetParam(), 20);
        BodyDescription& body = is_box
                                    ? add_box(scene, {0, 0, kRadius + height}, {0.1, 0.1, 0.1}, 1)
                                    : add_sphere(scene, {0, 0, kRadius + height}, kRadius, 1);
        body.velocity = {kSpeed, 0, -0.2};
        World world = reference_world(scene);
        const double lift = h * kFriction * kSpeed, start = std::max(height, lift);
        for (int k = 0; k * h < 0.06; ++k) {
          world.step();
          const BodyStates s = world.states();
          ASSERT_LT(s.position[1].z, kRadius + start + 1e-3)
              << "h " << h << (is_box ? " box" : " sphere") << " step " << k;
          ASSERT_LT(s.velocity[1].z, 0.1)
              << "h " << h << (is_box ? " box" : " sphere") << " step " << k;
        }
      }
    }
  }
}

TEST(SlidingLanding, OnABodyDoesNotBounce) {
  for (const bool is_box : {false, true}) {
    Scene scene = empty_scene(1e-3, 0.5);
    scene.gravity = {0, 0, -kGravity};
    add_box(scene, {0, 0, -1}, {20, 20, 1}, 1e9).locks = lock_all;
    BodyDescription& body = is_box ? add_box(scene, {0, 0, 0.1121}, {0.1, 0.1, 0.1}, 1)
                                   : add_sphere(scene, {0, 0, 0.1121}, 0.1, 1);
    body.velocity = {10, 0, -0.2};
    World world = reference_world(scene);
    for (int k = 0; k < 60; ++k) {
      world.step();
      ASSERT_LT(world.states().velocity[1].z, 0.1) << "step " << k;
    }
  }
}

}  // namespace
}  // namespace scree::physics
