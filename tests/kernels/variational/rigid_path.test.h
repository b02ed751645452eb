#pragma once
// The way of a free body: its rates against differences, and its bounds against many samples.

#include "tests/backend_fixture.h"
#include "tests/kernels/variational/random_motion.h"

namespace scree {
namespace {

RigidPath random_path(std::mt19937& random, double fastest) {
  std::uniform_real_distribution<double> uniform(0, 1);
  RigidPath p;
  p.start = 0.3;
  p.node = {normal_vector(random), random_turn(random)};
  p.velocity = normal_vector(random);
  p.acceleration = {0, 0, -9.81};
  p.moments = random_moments(random);
  p.momentum = hadamard(p.moments, (fastest * uniform(random)) * normal_vector(random));
  return p;
}

TEST(RigidPathTest, RatesAreThoseOfItsPoses) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    RigidPath p = random_path(random, 2);
    const double t = 0.4, dt = 1e-5;
    const BodyPose before = p.pose(t - dt), after = p.pose(t + dt);
    const Vec3d turn = turn_of(after.orientation * conjugate(before.orientation));
    const double size = 1 + norm(p.rate(t)) * norm(p.rate(t));
    EXPECT_LT(norm((0.5 / dt) * turn - p.rate(t)), 1e-7 * size * size) << trial;
    EXPECT_LT(norm((0.5 / dt) * (after.position - before.position) - p.velocity_at(t)), 1e-9);
  }
}

TEST(RigidPathTest, BoundsHoldAllTheWay) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 3000; ++trial) {
    RigidPath p = random_path(random, 3);
    p.bound_rotation(0.6);
    constexpr int kSamples = 100;
    Vec3d before = p.rate(0.3);
    for (int k = 1; k <= kSamples; ++k) {
      const Vec3d now = p.rate(0.3 + 0.3 * k / kSamples);
      EXPECT_LE(norm(now), (1 + 1e-12) * p.most_rate) << trial;
      EXPECT_LE(norm(now - before), 0.3 / kSamples * p.most_change + 1e-12 * p.most_rate) << trial;
      before = now;
    }
  }
}

TEST(RigidPathTest, BoundsOfRoundBodiesAreTheRates) {
  RigidPath p;
  p.moments = {1, 1, 0.2};
  p.momentum = {0.6, 0.8, 0.1};
  p.bound_rotation(1e-6);
  EXPECT_NEAR(p.most_rate, norm(p.rate(0)), 2e-6);
  EXPECT_NEAR(p.most_change, 0.8 * 0.5 * 1, 2e-6) << "the axis goes around it";
}

TEST(RigidPathTest, WallsStay) {
  RigidPath wall = RigidPath::fixed({1, 2, 3}, exp_map(Vec3d{0.1, 0, 0}));
  wall.bound_rotation(1);
  EXPECT_EQ(wall.pose(7).position, (Vec3d{1, 2, 3}));
  EXPECT_EQ(wall.change_of_turn(), 0);
}

}  // namespace
}  // namespace scree
