// Free rotation of a body with three different moments: when it flips, and what it conserves. A top
// on a sticking tip: its precession.

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

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

// The scheme is of second order; at h = 1e-3 with spin 5 its period is off by about
// (h w)^2 / 12 = 2e-6.
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

/// A heavy symmetric top in steady precession: a rod without thickness to speak of that stands on
/// its lower end and is tilted by theta. It precesses at the slow root of
///   (I1 + m L^2) cos(theta) W^2 - I3 w3 W + m g L = 0.
struct SteadyTop {
  double mass = 1, length = 0.1, i1 = 1e-3, i3 = 2e-3;  ///< L: from the tip to the center of mass
  double theta = kPi / 6, spin = 100;                   ///< w3 [rad/s]
  double precession() const {
    const double a = (i1 + mass * length * length) * std::cos(theta), b = i3 * spin;
    const double c = mass * kGravity * length;
    return (b - std::sqrt(b * b - 4 * a * c)) / (2 * a);
  }
};

struct FreeTopErrors {
  double angle = 0;   ///< of the precession after the run, relative
  double tilt = 0;    ///< largest change of theta [rad]
  double tip = 0;     ///< largest way of the tip [m]
  double energy = 0;  ///< largest change of kinetic and potential energy, relative to the former
};
FreeTopErrors precess_freely(double h, double duration) {
  constexpr double kThin = 1e-12;
  const SteadyTop top;
  const double rate = top.precession();
  Scene scene = empty_scene(h, 10);
  solve_to(scene, 1e-8);  // gaps of the vertices of the tip differ by 1e-12 m
  add_plane(scene);
  const Vec3d axis{std::sin(top.theta), 0, std::cos(top.theta)};
  BodyDescription& rod = add_box(scene, top.length * axis, {kThin, kThin, top.length}, top.mass);
  rod.inertia = {top.i1, top.i1, top.i3};
  rod.orientation = exp_map(Vec3d{0, top.theta, 0});
  rod.angular_velocity = rate * Vec3d{0, 0, 1} + (top.spin - rate * std::cos(top.theta)) * axis;
  rod.velocity = cross(rod.angular_velocity, top.length * axis);

  World world = reference_world(scene);
  const auto energy = [&](const BodyStates& s) {
    const Vec3d w = rotate_back(s.orientation[1], s.angular_velocity[1]);
    return 0.5 * top.mass * norm2(s.velocity[1]) +
           0.5 * dot(w, hadamard(Vec3d{top.i1, top.i1, top.i3}, w)) +
           top.mass * kGravity * s.position[1].z;
  };
  const double start = energy(world.states());
  FreeTopErrors worst;
  double turned = 0, before = 0;
  const int steps = steps_for(scene, duration);
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(world.step().converged);
    const BodyStates s = world.states();
    const Vec3d now = rotate(s.orientation[1], Vec3d{0, 0, 1});
    const double azimuth = std::atan2(now.y, now.x);
    turned += std::remainder(azimuth - before, 2 * kPi);
    before = azimuth;
    worst.tilt = std::max(worst.tilt, std::abs(std::acos(now.z) - top.theta));
    worst.tip = std::max(worst.tip, norm(s.position[1] - top.length * now));
    worst.energy = std::max(worst.energy, std::abs(energy(s) - start));
  }
  worst.energy /= 0.5 * top.i3 * top.spin * top.spin;
  worst.angle = std::abs(turned / (rate * world.time()) - 1);
  return worst;
}

// Its axis stays where it is in the body, and so does its energy. Products of quaternions that are rounded to one side took 2e-4 of
// it in these steps.
TEST(Rotation, ASteadySpinAboutALockedAxisKeepsItsEnergyInFloat) {
  Scene scene = top(5e-4, {0, 0, 3});
  scene.bodies[0].orientation = exp_map((40 * kPi / 180 / std::sqrt(14)) * Vec3d{1, 2, 3});
  scene.bodies[0].locks = static_cast<std::uint8_t>(lock_rx | lock_ry);
  World world(scene, cpu_options(1, Precision::single_precision));
  const double start = world.step().kinetic_energy;
  StepReport report;
  for (int k = 0; k < 30'000; ++k) report = world.step();
  EXPECT_NEAR(report.kinetic_energy, start, 3e-5 * start);
}

// What locks an axis gives a moment about that one, which does no work.
TEST(Rotation, ALockedAxisKeepsTheMomentumAboutTheOthers) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d spin{4, 3, 2};
    spin[axis] = 0;
    Scene scene = top(1e-3, spin);
    scene.bodies[0].orientation = exp_map(Vec3d{0.6, -0.4, 0.5});
    scene.bodies[0].locks = static_cast<std::uint8_t>(lock_rx << axis);
    World world = reference_world(scene);
    const auto momentum = [&] {
      const BodyStates s = world.states();
      const Vec3d w = rotate_back(s.orientation[0], s.angular_velocity[0]);
      return rotate(s.orientation[0], Vec3d{1 * w.x, 2 * w.y, 3 * w.z});
    };
    const Vec3d start = momentum();
    const double energy = 0.5 * dot(start, spin);
    for (int k = 0; k < 2000; ++k) world.step();
    const Vec3d end = momentum(), w = world.states().angular_velocity[0];
    EXPECT_EQ(w[axis], 0);
    for (int other = 0; other < 3; ++other)
      if (other != axis) {
        EXPECT_NEAR(end[other], start[other], 1e-9) << axis << other;
      }
    EXPECT_GT(norm(w - spin), 0.01);
    EXPECT_NEAR(0.5 * dot(end, w), energy, 1e-4 * energy);
  }
}

TEST(Rotation, TopOnAStickingTipPrecessesToSecondOrder) {
  const FreeTopErrors coarse = precess_freely(1e-3, 2), fine = precess_freely(5e-4, 2);
  for (const auto& [name, c, f] :
       {std::tuple{"angle", coarse.angle, fine.angle}, std::tuple{"tilt", coarse.tilt, fine.tilt},
        std::tuple{"tip", coarse.tip, fine.tip}}) {
    RecordProperty(std::string(name) + "_coarse", std::to_string(1e6 * c));
    RecordProperty(std::string(name) + "_fine", std::to_string(1e6 * f));
  }
  EXPECT_LT(coarse.angle, 0.01);
  EXPECT_LT(coarse.tilt, radians(2));
  EXPECT_LT(coarse.tip, 2e-3);
  EXPECT_LT(coarse.energy, 1e-3);
  EXPECT_GT(coarse.angle / fine.angle, 3);
  EXPECT_GT(coarse.tilt / fine.tilt, 3);
}

}  // namespace
}  // namespace scree::physics
