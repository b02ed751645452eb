// Long, thin bodies: their moments differ by thousands, so what is small for other bodies is not for them.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "kernels/step/integrate.h"
#include "kernels/variational/free_rotation.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

double turn_between(const Quatd& a, const Quatd& b) {
  const Quatd c = conjugate(a) * b;
  return 2 * std::atan2(norm(c.vec()), std::abs(c.w));
}

double energy_of(const Vec3d& moments, const Quatd& q, const Vec3d& w) {
  const Vec3d own = rotate_back(q, w);
  return 0.5 * dot(own, hadamard(moments, own));
}

/// A turn that is known: two equal moments, the third of any size, up to a hundred radians a step. The series of the
/// exact discrete Lagrangian shares nothing with it.
TEST(FreeTurns, OfBodiesWithTwoEqualMomentsAreExact) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-4, 0.3), part(-1, 1);
  for (int trial = 0; trial < 300; ++trial) {
    Vec3d moments{1, 1, 1};
    const int own = trial % 3;
    moments[own] = std::min(1.99, std::pow(10, exponent(random)));
    Vec3d spin{part(random), part(random), part(random)};
    spin[own] *= 100;
    const Quatd start = exp_map(Vec3d{part(random), part(random), part(random)});
    const double h = 0.7;
    Quatd q = start;
    Vec3d w = rotate(start, spin);
    const Vec3d momentum = rotate(start, hadamard(moments, spin));
    if (h * norm(hadamard(moments, spin)) / std::min({moments.x, moments.y, moments.z}) < 0.3)
      continue;              // the midpoint rule
    Vec3d almost = moments;  // the other is then found by its series
    almost[(own + 1) % 3] *= 1 + 1e-13;
    const double energy = energy_of(moments, q, w);
    rotate_free(h, moments, q, w);
    EXPECT_LT(turn_between(q, turned_freely(almost, momentum, h, start)), 1e-9) << trial;
    EXPECT_NEAR(energy_of(moments, q, w), energy, 1e-11 * energy);
    EXPECT_LT(norm(rotate(q, hadamard(moments, rotate_back(q, w))) - momentum),
              1e-12 * norm(momentum));
  }
}

/// Three different moments: of second order against the series, with bounded energy, however long and thin.
TEST(FreeTurns, OfOtherBodiesAreOfSecondOrder) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> exponent(-4, 0), part(-1, 1);
  double coarse[2] = {}, fine[2] = {};  // by the midpoint rule; in known turns
  for (int trial = 0; trial < 200; ++trial) {
    Vec3d moments;  // of a cloud of points, so that they can be
    const Vec3d extent{1, std::pow(10, exponent(random)), std::pow(10, exponent(random))};
    for (int k = 0; k < 3; ++k)
      moments[k] =
          extent[(k + 1) % 3] * extent[(k + 1) % 3] + extent[(k + 2) % 3] * extent[(k + 2) % 3];
    Vec3d spin{5 * part(random), part(random), part(random)};
    const Quatd start = exp_map(Vec3d{part(random), part(random), part(random)});
    const Vec3d momentum = rotate(start, hadamard(moments, spin));
    const auto error = [&](int steps) {
      const double h = 1.0 / steps;
      Quatd q = start;
      Vec3d w = rotate(start, spin);
      for (int k = 0; k < steps; ++k) rotate_free(h, moments, q, w);
      EXPECT_NEAR(energy_of(moments, q, w), energy_of(moments, start, rotate(start, spin)),
                  0.02 * energy_of(moments, start, rotate(start, spin)))
          << trial << ", " << steps;
      return turn_between(q, turned_freely(moments, momentum, 1, start));
    };
    const double measure = norm(momentum) / std::min({moments.x, moments.y, moments.z});
    const std::size_t rule = measure / 50 < kMostMidpointTurn ? 0 : 1;
    if (rule == 1 && measure / 100 < kMostMidpointTurn) continue;  // one of them by each
    coarse[rule] += error(50);
    fine[rule] += error(100);
  }
  for (const std::size_t rule : {0u, 1u}) {
    EXPECT_GT(coarse[rule], 0);
    EXPECT_LT(fine[rule], 0.1) << rule;
    EXPECT_LT(fine[rule], coarse[rule] / 3.5) << rule;
  }
}

/// A frictionless rod that bounces without loss: the search of the midpoint rule went astray where it had landed flat
/// and turned slowly, and gave it thousands of times its energy. Kinetic and potential energy never exceed the first.
TEST(ThinBodies, ABouncingRodGainsNoEnergy) {
  for (const RestitutionLaw law : {RestitutionLaw::poisson, RestitutionLaw::newton}) {
    for (const double width : {0.002, 0.0021, 0.02}) {
      Scene scene = empty_scene(0.01, 0);
      scene.stepping.restitution_law = law;
      scene.materials[0].restitution = 1;
      add_plane(scene);
      BodyDescription& rod = add_box(scene, {0, 0, 1.5}, {0.5, 0.002, width}, 0.016);
      rod.orientation = exp_map(Vec3d{0, 0.3, 0});
      rod.angular_velocity = {0, 0.1, 0};
      World world(scene, cpu_options());
      const double start = 0.016 * kGravity * 1.5;
      double most = 0;
      for (int k = 0; k < 10000; ++k) {
        const StepReport r = world.step();
        const double height = world.states().position[static_cast<std::size_t>(last_id(scene))].z;
        most = std::max(most, r.kinetic_energy + 0.016 * kGravity * height);
      }
      // In a step of free fall by v' = v + h g the sum is off by m g^2 h^2 / 2 and what an impact leaves of a step.
      EXPECT_LT(most, start * 1.1) << width << (law == RestitutionLaw::newton ? ", newton" : "");
    }
  }
}

}  // namespace
}  // namespace scree::physics
