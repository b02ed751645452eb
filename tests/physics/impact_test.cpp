// Impacts of one sphere, and what collisions conserve.

#include <gtest/gtest.h>

#include "shapes/container.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

class Bounce : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Impact, Bounce, ::testing::Values(0.5, 0.8), [](const auto& info) {
  return "e" + std::to_string(static_cast<int>(std::lround(10 * info.param)));
});

TEST_P(Bounce, A19_HeightsAndTotalTimeOfABouncingBall) {
  const double e = GetParam(), h0 = 1, r = 0.1, h = 2e-4;
  Scene scene = empty_scene(h, 0.5);
  scene.materials[0].restitution = e;
  add_plane(scene);
  add_sphere(scene, {0, 0, r + h0}, r, 1);
  World world = reference_world(scene);
  const double total = std::sqrt(2 * h0 / kGravity) * (1 + e) / (1 - e);
  EXPECT_NEAR(total, e == 0.5 ? 1.35457 : 4.0637, 5e-5);

  constexpr double at_rest = 1e-8;  // [m/s]
  double peak = 0, before = 0, last_motion = 0;
  int bounces = 0;
  double impact_speed = 0;
  const auto check_peak = [&] {
    if (bounces == 0) return;
    EXPECT_NEAR(peak, std::pow(e, 2 * bounces) * h0, 2 * impact_speed * h) << "bounce " << bounces;
  };
  const int steps = steps_for(scene, 1.1 * total);
  for (int k = 0; k < steps; ++k) {
    world.step();
    const BodyStates s = world.states();
    const double v = s.velocity[1].z;
    if (before < -at_rest && v > 0) {
      check_peak();
      ++bounces;
      impact_speed = std::sqrt(2 * kGravity * h0) * std::pow(e, bounces - 1);
      peak = 0;
    }
    peak = std::max(peak, s.position[1].z - r);
    if (std::abs(v) > at_rest) last_motion = world.time();
    before = v;
  }
  EXPECT_NEAR(last_motion, total, 0.01 * total);
  EXPECT_LT(std::abs(world.states().velocity[1].z), at_rest);
  EXPECT_LT(std::abs(world.states().position[1].z - r), 1e-6);
  EXPECT_GT(bounces, 5);
}

TEST(Impact, A20_ObliqueImpactWithSpin) {
  const double r = 0.1, e = 0.5, mu = 0.3, u_n = 2;
  for (const double slip : {2.0, 3.1, 3.2, 5.0}) {  // sticks up to 3.15
    Scene scene = empty_scene(1e-3, mu, Model::exact);
    scene.gravity = {};
    scene.materials[0].restitution = e;
    solve_to(scene, 1e-12);
    add_plane(scene);
    // The sliding direction lies between the axes; a third of the slip comes from spin.
    const Vec3d along{0.6, 0.8, 0};
    const Vec3d axis =
        cross(Vec3d{0, 0, 1}, along);  // spin about it carries the lowest point backward
    BodyDescription& ball = add_sphere(scene, {0, 0, r}, r, 1.7);
    ball.velocity = 2 * slip / 3 * along - Vec3d{0, 0, u_n};
    ball.angular_velocity = -slip / 3 / r * axis + Vec3d{0, 0, 3};
    const Vec3d v0 = ball.velocity, w0 = ball.angular_velocity;
    World world = reference_world(scene);
    EXPECT_TRUE(world.step().converged);

    const bool sticks = mu * (1 + e) * u_n >= 2.0 / 7 * slip;
    const double dv = sticks ? 2.0 / 7 * slip : mu * (1 + e) * u_n;
    const BodyStates s = world.states();
    EXPECT_NEAR(dot(s.velocity[1] - v0, along), -dv, 1e-8) << slip;
    EXPECT_NEAR(r * dot(s.angular_velocity[1] - w0, axis), 2.5 * dv, 1e-8) << slip;
    EXPECT_NEAR(s.velocity[1].z, e * u_n, 1e-8) << slip;
    EXPECT_NEAR(s.angular_velocity[1].z, 3, 1e-8) << slip;
    EXPECT_NEAR(dot(s.velocity[1], cross(Vec3d{0, 0, 1}, along)), 0, 1e-8) << slip;
  }
}

/// A box in a container without gravity, thrown at its walls with spin.
Scene thrown_box(std::uint32_t seed, double e, double friction) {
  Scene scene = empty_scene(1e-3, friction);
  scene.gravity = {};
  scene.materials[0].restitution = e;
  solve_to(scene, 1e-10);
  scene.stepping.restitution_threshold = 0;
  BodyDescription walls;
  walls.kind = BodyKind::fixed;
  walls.shape.kind = shapes::Container::kind;
  walls.shape.half_extents = {0.3, 0.3, 0.3};
  scene.bodies.push_back(walls);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  BodyDescription& box = add_box(scene, {}, {0.05, 0.1, 0.07}, 1.4);
  const double vx = normal(random), vy = normal(random), vz = normal(random);
  const double wx = normal(random), wy = normal(random), wz = normal(random);
  box.velocity = {vx, vy, vz};
  box.angular_velocity = 5.0 * Vec3d{wx, wy, wz};
  return scene;
}

// With friction Newton's law gives a box that hits the wall with a corner too much: the friction
// that turns it is work that the prescribed normal velocity does not know of. Free rotation changes
// the energy by 1e-5 at most.
// The convex law stops what slides before it touches, by h mu |u_t|: it bounces all the same, with any step, wherever it is in it.
TEST(Impact, BallsThatComeAskewBounceInTheConvexModel) {
  constexpr double e = 0.6, r = 0.02;
  for (const double h : {1e-3, 1e-4}) {
    for (const double mu : {0.1, 0.5}) {
      for (const double slip : {1.0, 3.0}) {
        SCOPED_TRACE(testing::Message() << h << " s, friction " << mu << ", " << slip << " m/s");
        const bool sticks = slip <= 3.5 * mu * (1 + e);
        const double after = sticks ? slip * 5 / 7 : slip - mu * (1 + e);
        for (int k = 0; k < 6; ++k) {
          Scene scene = empty_scene(h, mu);
          scene.gravity = {};
          scene.materials[0].restitution = e;
          add_plane(scene);
          add_sphere(scene, {0, 0, r + 20 * h + k * h / 6}, r, 1).velocity = {slip, 0, -1};
          World world = reference_world(scene);
          for (int step = 0; step < 30; ++step) world.step();
          const Vec3d v = world.states().velocity[1];
          EXPECT_NEAR(v.z, e, 1e-3) << k;
          EXPECT_NEAR(v.x, after, 1e-3) << k;
        }
      }
    }
  }
}

TEST(Impact, A22_BoxesWithFrictionNeverGainEnergy) {
  for (const double e : {1.0, 0.8}) {
    double lost = 0;
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      World world = reference_world(thrown_box(seed, e, 0.5));
      double before = world.step().kinetic_energy;
      const double start = before;
      for (int k = 0; k < 1500; ++k) {
        const StepReport report = world.step();
        EXPECT_LT(report.kinetic_energy, before + 1e-4 * start) << seed << " " << k;
        before = report.kinetic_energy;
      }
      lost += 1 - before / start;
    }
    EXPECT_GT(lost / 8, 0.05) << e;
  }
}

/// 200 spheres in vacuum, dense enough to collide a few times.
Scene cloud(double h, double restitution, std::uint32_t seed) {
  Scene scene = empty_scene(h, 0.4);
  scene.gravity = {};
  scene.materials[0].restitution = restitution;
  solve_to(scene, 1e-12);
  add_lattice(scene, 200, 6, 6, {-0.3, -0.3, -0.3}, 0.13, 0.05, 1000, seed);
  std::mt19937 random(seed + 100);
  std::normal_distribution<double> normal;
  for (BodyDescription& body : scene.bodies) {
    const double vx = normal(random), vy = normal(random), vz = normal(random);
    const double wx = normal(random), wy = normal(random), wz = normal(random);
    body.velocity = {vx, vy, vz};
    body.angular_velocity = 10.0 * Vec3d{wx, wy, wz};
  }
  return scene;
}

/// Change of the angular momentum over 0.2 s, RMS over seeds; checks the linear
/// momentum on the way.
double angular_drift(double h, double restitution) {
  double squares = 0;
  const int seeds = 30;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    const Scene scene = cloud(h, restitution, seed);
    World world = reference_world(scene);
    const Momenta before = momenta_of(world.states(), scene);
    int contacts = 0;
    for (int k = 0; k < steps_for(scene, 0.1); ++k) contacts += world.step().contact_count;
    EXPECT_GT(contacts, 200);
    const Momenta after = momenta_of(world.states(), scene);
    EXPECT_LT(norm(after.linear - before.linear), 1e-12 * 200);
    squares += norm2(after.angular - before.angular);
  }
  return std::sqrt(squares / seeds);
}

class Vacuum : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Impact, Vacuum, ::testing::Values(0.5, 1.0), [](const auto& info) {
  return "e" + std::to_string(static_cast<int>(std::lround(10 * info.param)));
});

// The force of a contact acts on two points a gap apart, so the angular momentum changes by gap x
// force, of random sign, with gaps of order h |v|: it halves with the step. Thirty clouds leave a
// scatter of about a ninth in the ratio of their RMS values; over two halvings the ratio 4 is
// told from 2 and 8.
TEST_P(Vacuum, A22_CollisionsConserveMomentum) {
  const double coarse = angular_drift(1e-3, GetParam());
  const double fine = angular_drift(2.5e-4, GetParam());
  RecordProperty("drift_ratio", std::to_string(coarse / fine));
  EXPECT_GT(coarse / fine, 2.8);
  EXPECT_LT(coarse / fine, 5.7);
}

}  // namespace
}  // namespace scree::physics
