// Contacts that pull: p_n >= -c h and |p_t| <= mu (p_n + c h).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "tests/physics/long_tests.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// Moves by less than this [m] within 0.5 s: holds. A load 1 % over the limit moves
/// a body by 12 mm.
constexpr double kHolds = 1e-6;
constexpr double kLetsGo = 5e-3;

Scene sticky_scene(double force, double mu) {
  Scene scene = empty_scene(1e-3, mu);
  scene.materials[0].cohesion = force;
  scene.stepping.envelope = 1e-4;
  return scene;
}

double shift_of_body_1(const Scene& scene) {
  World world = reference_world(scene);
  const Vec3d start = world.states().position[1];
  run_for(world, scene, 0.5);
  return norm(world.states().position[1] - start);
}

TEST(Cohesion, C60_SphereHangsUnderASphere) {
  const double m = 0.2, r = 0.02;
  for (const double share : {0.99, 1.01}) {
    Scene scene = sticky_scene(share * m * kGravity, 0.4);
    add_sphere(scene, {0, 0, 2 * r}, r, m).kind = BodyKind::fixed;
    add_sphere(scene, {}, r, m);
    const double shift = shift_of_body_1(scene);
    if (share > 1) {
      EXPECT_LT(shift, kHolds);
    }
    if (share < 1) {
      EXPECT_GT(shift, kLetsGo);
    }
  }
}

/// A block with one resultant contact: a sphere that cannot turn, on a plane.
Scene sticky_block(double force, double mu, double m) {
  Scene scene = sticky_scene(force, mu);
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.05}, 0.05, m).locks = lock_rotation;
  return scene;
}

TEST(Cohesion, C61_BlockOnAnIncline) {
  const double m = 0.7, mu = 0.3;
  for (const double ratio : {0.5, 1.0}) {  // c / (m g)
    // sin(theta) = mu (cos(theta) + ratio)
    const double limit = std::asin(mu * ratio / std::sqrt(1 + mu * mu)) + std::atan(mu);
    if (ratio == 1) {
      EXPECT_NEAR(limit / kPi * 180, 33.398, 5e-4);
    }
    for (const double share : {0.99, 1.01}) {
      Scene scene = sticky_block(ratio * m * kGravity, mu, m);
      tilt(scene, share * limit / kPi * 180);
      const double shift = shift_of_body_1(scene);
      if (share < 1) {
        EXPECT_LT(shift, kHolds) << "c/(m g) = " << ratio;
      }
      if (share > 1) {
        EXPECT_GT(shift, kLetsGo) << "c/(m g) = " << ratio;
      }
    }
  }
}

TEST(Cohesion, C61_BlockHangsFromACeiling) {
  const double m = 0.7;
  for (const double share : {0.99, 1.01}) {
    Scene scene = sticky_block(share * m * kGravity, 0.3, m);
    tilt(scene, 180);
    const double shift = shift_of_body_1(scene);
    if (share > 1) {
      EXPECT_LT(shift, kHolds);
    }
    if (share < 1) {
      EXPECT_GT(shift, kLetsGo);
    }
  }
}

TEST(Cohesion, C62_FourContactsHoldFourTimesTheForce) {
  const double m = 0.3;
  for (const double share : {0.99, 1.01}) {  // load / (4 c)
    Scene scene = sticky_scene(m * kGravity / (4 * share), 0.4);
    scene.gravity = {0, 0, kGravity};  // pulls the cube off the plane
    add_plane(scene);
    add_box(scene, {0, 0, 0.05}, {0.05, 0.05, 0.05}, m);
    const double shift = shift_of_body_1(scene);
    if (share < 1) {
      EXPECT_LT(shift, kHolds);
    }
    if (share > 1) {
      EXPECT_GT(shift, kLetsGo);
    }
  }
}

/// The cone's apex is moved as a whole: a contact that is pulled can still carry moments, until
/// r m g sin = mu_r (m g cos + c).
TEST(Cohesion, C63_SphereDoesNotRollOffAnOverhang) {
  const double m = 0.2, r = 0.05, angle = 170;
  const double pull = m * kGravity * std::cos(radians(angle));  // negative
  const double force = 2 * m * kGravity;
  const double limit = r * m * kGravity * std::sin(radians(angle)) / (pull + force);
  EXPECT_NEAR(limit, 0.171050 * r, 1e-6 * r);
  for (const bool exact : {false, true}) {
    for (const double share : {0.96, 1.01}) {  // mu_r over the limit
      Scene scene = sticky_scene(force, 0.6);
      scene.solver.exact_coulomb = exact;
      scene.materials[0].rolling_friction = share * limit;
      add_plane(scene);
      add_sphere(scene, {0, 0, r}, r, m);
      tilt(scene, angle);
      const double shift = shift_of_body_1(scene);
      if (share > 1) {
        EXPECT_LT(shift, kHolds) << exact;
      }
      if (share < 1) {
        EXPECT_GT(shift, kLetsGo) << exact;
      }
    }
  }
}

/// Grains of 1 cm that stand free, as they were poured.
struct Packing {
  static constexpr double kRadius = 0.01, kDensity = 2000;
  static constexpr double kMass = kDensity * 4 / 3 * kPi * kRadius * kRadius * kRadius;
  std::vector<Vec3d> center;
  double height = 0;
};
double height_of(const std::vector<Vec3d>& center) {
  double top = 0;
  for (const Vec3d& x : center) top = std::max(top, x.z);
  return top + Packing::kRadius;
}

/// About a cube of grains that fell without friction between four walls and came to rest. A lattice would not do: its
/// columns buckle, whatever sticks.
Packing settled_cube(int edge) {
  constexpr double kRadius = Packing::kRadius, kSpacing = 2.06 * kRadius;
  Scene scene = empty_scene(1e-3, 0);
  solve_to(scene, 1e-3);
  const double half = (edge + 0.6) * kRadius, lowest = -0.5 * (edge - 1) * kSpacing;
  add_tank(scene, -half, half, -half, half);
  const auto walls = static_cast<std::ptrdiff_t>(scene.bodies.size());
  add_lattice(scene, edge * edge * edge, edge, edge, {lowest, lowest, 1.2 * kRadius}, kSpacing,
              kRadius, Packing::kDensity, 5);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> speed(-0.5, 0.5);
  for (auto body = scene.bodies.begin() + walls; body != scene.bodies.end(); ++body)
    body->velocity = {speed(random), speed(random), speed(random)};
  World world(scene, cpu_options(2));
  run_for(world, scene, 1);
  const std::vector<Vec3d> x = world.states().position;
  Packing packing{{x.begin() + walls, x.end()}, 0};
  packing.height = height_of(packing.center);
  return packing;
}

/// Height after the walls are gone for a while, over that before.
/// @param bond  cohesion of a contact over the weight of a grain
double height_left(const Packing& packing, double bond, double mu, double duration) {
  Scene scene = empty_scene(1e-3, mu);
  solve_to(scene, 1e-4);
  scene.materials[0].cohesion = bond * Packing::kMass * kGravity;
  scene.stepping.envelope = 1e-3 * Packing::kRadius;
  for (const Vec3d& x : packing.center) add_sphere(scene, x, Packing::kRadius, Packing::kMass);
  add_plane(scene);
  World world(scene, cpu_options(2));
  run_for(world, scene, duration);
  std::vector<Vec3d> x = world.states().position;
  x.resize(packing.center.size());  // without the floor
  return height_of(x) / packing.height;
}

// 125 grains, without cohesion and with much of it.
TEST(Cohesion, C63_SmallCubeOfGrainsStandsByItsCohesion) {
  const Packing cube = settled_cube(5);
  EXPECT_LT(height_left(cube, 0, 0.5, 0.5), 0.8);
  EXPECT_GT(height_left(cube, 100, 0.5, 0.5), 0.8);
}

// A cube of 1000 grains: what is left of its height, for more and more cohesion and friction.
TEST(Cohesion, C63_MapOfHeights) {
  if (!runs_long_tests()) GTEST_SKIP() << kLongTest;
  constexpr double kFrictions[] = {0.2, 0.5, 0.8}, kBonds[] = {0, 1, 5, 20, 100};
  const Packing cube = settled_cube(10);
  double left[3][5];
  for (int m = 0; m < 3; ++m) {
    for (int c = 0; c < 5; ++c) {
      left[m][c] = height_left(cube, kBonds[c], kFrictions[m], 2);
      std::printf("mu %.1f  c/(m g) %3.0f: %.3f of the height\n", kFrictions[m], kBonds[c],
                  left[m][c]);
      std::fflush(stdout);
    }
  }
  // One grain more or less on top is 0.05 of the height.
  constexpr double kGrain = 0.05;
  for (int m = 0; m < 3; ++m)
    for (int c = 0; c + 1 < 5; ++c) EXPECT_GT(left[m][c + 1], left[m][c] - kGrain) << m << " " << c;
  for (int m = 0; m + 1 < 3; ++m)
    for (int c = 0; c < 5; ++c) EXPECT_GT(left[m + 1][c], left[m][c] - kGrain) << m << " " << c;
  EXPECT_LT(left[1][0], 0.6);
  EXPECT_GT(left[1][3], 0.8);
  EXPECT_GT(left[1][4], 0.8);
}

}  // namespace
}  // namespace scree::physics
