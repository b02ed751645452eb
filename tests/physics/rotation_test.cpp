// Free rotation of a body with three different moments: when it flips, and what it conserves.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

Scene top(double h, const Vec3d& spin) {
  Scene scene = empty_scene(h, 0);
  scene.gravity = {};
  BodyDescription& body = add_box(scene, {}, {0.5, 0.5, 0.5}, 1);
  body.inertia = {1, 2, 3};
  body.angular_velocity = spin;
  return scene;
}

/// Times at which the body component omega_y changes sign, by linear interpolation [s].
std::vector<double> flips(double h, const Vec3d& spin, double duration) {
  const Scene scene = top(h, spin);
  World world = reference_world(scene);
  std::vector<double> times;
  double before = spin.y;
  const int steps = steps_for(scene, duration);
  for (int k = 1; k <= steps; ++k) {
    world.step();
    const BodyStates s = world.states();
    const double now = rotate_back(s.orientation[0], s.angular_velocity[0]).y;
    if (before * now < 0) times.push_back(h * (k - now / (now - before)));
    before = now;
  }
  return times;
}

// The scheme is of second order; at h = 1e-3 with spin 5 its period is off by about (h w)^2 / 12 =
// 2e-6.
TEST(Rotation, A50_IntermediateAxisFlips) {
  const std::vector<double> times = flips(1e-3, {0.01, 5, 0.01}, 100);
  ASSERT_GE(times.size(), 19u);
  EXPECT_NEAR(times[0], 2.74107, 1e-4);
  EXPECT_NEAR(times[1], 7.76700, 1e-4);
  EXPECT_NEAR(times[2], 12.79293, 1e-4);
  for (std::size_t k = 1; k < times.size(); ++k)
    EXPECT_NEAR(times[k] - times[k - 1], 5.025929, 1e-4) << "flip " << k;
}

TEST(Rotation, A51_SlowFlips) {
  const std::vector<double> times = flips(2e-3, {0.01, 1, 0}, 100);
  ASSERT_GE(times.size(), 5u);
  EXPECT_NEAR(times[0], 10.37730, 1e-4);
  for (std::size_t k = 1; k < times.size(); ++k)
    EXPECT_NEAR(times[k] - times[k - 1], 20.75461, 2e-4) << "flip " << k;
}

struct Drift {
  double energy = 0;        ///< largest relative change
  double energy_early = 0;  ///< the same over the first half
  double momentum = 0;      ///< largest relative change of the spatial angular momentum
};
Drift drift(double h) {
  const Scene scene = top(h, {0.01, 5, 0.01});
  World world = reference_world(scene);
  const Vec3d moments{1, 2, 3};
  const Vec3d l0 = hadamard(moments, Vec3d{0.01, 5, 0.01});
  const double e0 = 0.5 * dot(l0, Vec3d{0.01, 5, 0.01});
  Drift d;
  const int steps = steps_for(scene, 100);
  for (int k = 0; k < steps; ++k) {
    world.step();
    const BodyStates s = world.states();
    const Vec3d w = rotate_back(s.orientation[0], s.angular_velocity[0]);
    const Vec3d l = rotate(s.orientation[0], hadamard(moments, w));
    const double energy = std::abs(0.5 * dot(w, hadamard(moments, w)) / e0 - 1);
    d.energy = std::max(d.energy, energy);
    if (k < steps / 2) d.energy_early = std::max(d.energy_early, energy);
    d.momentum = std::max(d.momentum, norm(l - l0) / norm(l0));
  }
  return d;
}

TEST(Rotation, A50_FreeRotationConservesMomentumAndEnergy) {
  const Drift coarse = drift(0.01), fine = drift(0.005);
  EXPECT_LT(coarse.momentum, 1e-12);
  EXPECT_LT(fine.momentum, 1e-12);
  EXPECT_LT(coarse.energy, 1.1e-4);
  EXPECT_LT(fine.energy, 2.8e-5);
  EXPECT_NEAR(coarse.energy / fine.energy, 4, 0.4);
  EXPECT_LT(coarse.energy, 1.02 * coarse.energy_early);  // no trend
  EXPECT_LT(fine.energy, 1.02 * fine.energy_early);
}

}  // namespace
}  // namespace scree::physics
