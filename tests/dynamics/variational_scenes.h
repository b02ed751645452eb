#pragma once
// Scenes of the variational model.

#include <algorithm>
#include <numeric>

#include "shapes/container.h"
#include "shapes/ellipsoid.h"
#include "tests/physics/scene_builder.h"

namespace scree::test {

using physics::add_sphere;
using physics::cpu_options;

inline constexpr double g = 9.81;  ///< [m/s^2]

/// No bodies and no gravity.
inline Scene variational_scene(double time_step, double restitution = 1) {
  Scene scene = physics::empty_scene(time_step, 0);
  scene.dynamics.type = "variational";
  scene.gravity = {};
  scene.materials[0].restitution = restitution;
  return scene;
}

/// Column of steps.csv, see variational_card.h.
enum Column : std::size_t {
  impacts,
  grazing,
  rounds,
  in_islands,
  energy,
  px,
  py,
  pz,
  lx,
  ly,
  lz,
  identity_error
};

inline Vec3d momentum(const StepReport& r) { return {r.own[px], r.own[py], r.own[pz]}; }
inline Vec3d angular_momentum(const StepReport& r) { return {r.own[lx], r.own[ly], r.own[lz]}; }

/// A periodic gas: spheres of diameter 1 and mass 1 on a jittered lattice, temperature 1.
inline Scene gas(int per_edge, double solid_fraction, double time_step, double restitution,
                 unsigned seed = 5) {
  Scene scene = variational_scene(time_step, restitution);
  const int count = per_edge * per_edge * per_edge;
  const double edge = std::cbrt(count * physics::kPi / 6 / solid_fraction), cell = edge / per_edge;
  scene.periodicity.periodic = {true, true, true};
  scene.periodicity.upper = {edge, edge, edge};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> shift(-0.5, 0.5);
  Vec3d sum;
  for (int k = 0; k < count; ++k) {
    const Vec3d site(k % per_edge + 0.5, k / per_edge % per_edge + 0.5,
                     k / per_edge / per_edge + 0.5);
    const Vec3d jitter{shift(random), shift(random), shift(random)};
    BodyDescription& body = add_sphere(scene, cell * site + (cell - 1.001) * jitter, 0.5, 1);
    body.velocity = {normal(random), normal(random), normal(random)};
    sum += body.velocity;
  }
  double square = 0;
  for (BodyDescription& body : scene.bodies) {
    body.velocity -= (1.0 / count) * sum;
    square += norm2(body.velocity) / 3 / count;
  }
  for (BodyDescription& body : scene.bodies) body.velocity *= 1 / std::sqrt(square);
  return scene;
}

}  // namespace scree::test
