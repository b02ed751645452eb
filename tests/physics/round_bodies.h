#pragma once
// Capsules and cylinders for scenes in code.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/state_hash.h"
#include "shapes/capsule.h"
#include "shapes/cylinder.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {

inline const Quatd kAlongX = exp_map(Vec3d{0, kPi / 2, 0});
inline const Quatd kAlongY = exp_map(Vec3d{-kPi / 2, 0, 0});

inline BodyDescription round_body(ShapeKind kind, const Vec3d& position, const Quatd& orientation,
                                  double radius, double half_length, double density = 1000) {
  BodyDescription body;
  body.shape.kind = kind;
  body.shape.half_extents = {radius, radius, half_length};
  body.position = position;
  body.orientation = orientation;
  set_mass_from_density(body, density);
  return body;
}

/// @param length  between the centers of its ends
inline BodyDescription capsule(const Vec3d& position, const Quatd& orientation, double radius,
                               double length, double density = 1000) {
  return round_body(shapes::Capsule::kind, position, orientation, radius, radius + length / 2,
                    density);
}
inline BodyDescription cylinder(const Vec3d& position, const Quatd& orientation, double radius,
                                double length) {
  return round_body(shapes::Cylinder::kind, position, orientation, radius, length / 2);
}

/// A scene comes to rest without deep overlaps, with equal bits on one and two threads. Returns its state.
/// @param most_energy  after the last hundred steps [J]
inline BodyStates expect_pile_rests(const Scene& scene, int steps, double most_energy) {
  World one(scene, cpu_options(1)), two(scene, cpu_options(2));
  double deepest = 0, late = 0;
  for (int k = 0; k < steps; ++k) {
    const StepReport report = one.step();
    two.step();
    if (k > 600) deepest = std::max(deepest, report.max_penetration);
    if (k > steps - 100) late = std::max(late, report.kinetic_energy);
  }
  EXPECT_EQ(state_hash(one.states()), state_hash(two.states()));
  EXPECT_LT(deepest, 0.01 * 0.08);
  EXPECT_LT(late, most_energy);
  return one.states();
}

/// A sphere that would cross a rail of radius 0.1 m along x in one step is held back: by contacts,
/// and on its way after them.
inline void expect_stops_a_fast_sphere(BodyDescription rail) {
  Scene scene = empty_scene(1e-2, 0.3);
  scene.gravity = {};
  rail.kind = BodyKind::fixed;
  rail.mass = 0;
  rail.inertia = {};
  scene.bodies.push_back(rail);
  add_sphere(scene, {0, 0.01, 0.5}, 0.05, 1).velocity = {0, 0, -60};
  World world = reference_world(scene);
  double lowest = INFINITY;
  for (int k = 0; k < 20; ++k) {
    world.step();
    const Vec3d x = world.states().position[1];
    if (std::abs(x.y) < 0.1) lowest = std::min(lowest, x.z);
  }
  EXPECT_GT(lowest, 0.1);
}

}  // namespace scree::physics
