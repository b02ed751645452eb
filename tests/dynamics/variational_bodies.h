#pragma once
// Bodies of other shapes than spheres for scenes of the variational model.

#include "host/compounds.h"
#include "shapes/capsule.h"
#include "shapes/cone.h"
#include "shapes/cylinder.h"
#include "shapes/rounded.h"
#include "tests/dynamics/variational_scenes.h"
#include "tests/host/scene/shape_samples.h"
#include "tests/kernels/variational/random_motion.h"

namespace scree::test {

inline BodyDescription& add_room(Scene& scene, double half) {
  BodyDescription body;
  body.kind = BodyKind::fixed;
  body.shape.kind = shapes::Container::kind;
  body.shape.half_extents = {half, half, half};
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

inline BodyDescription& add_solid(Scene& scene, ShapeKind kind, const Vec3d& x, const Vec3d& half) {
  BodyDescription body;
  body.shape.kind = kind;
  body.shape.half_extents = half;
  body.shape.radius = half.x;
  body.position = x;
  set_mass_from_density(body, 1000);
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

/// Bodies of every shape that has no mesh, among them spheres, on a lattice.
inline Scene every_shape(double h, int per_edge, double cell, unsigned seed) {
  Scene scene = variational_scene(h);
  std::mt19937 random(seed);
  const ShapeKind kinds[] = {shapes::Sphere::kind,   shapes::Box::kind,  shapes::Capsule::kind,
                             shapes::Cylinder::kind, shapes::Cone::kind, shapes::Ellipsoid::kind};
  for (int k = 0; k < per_edge * per_edge * per_edge; ++k) {
    const Vec3d site(k % per_edge + 0.5, k / per_edge % per_edge + 0.5,
                     k / per_edge / per_edge + 0.5);
    const ShapeKind kind = kinds[static_cast<std::size_t>(k) % 6];
    const bool is_round = kind != shapes::Box::kind && kind != shapes::Ellipsoid::kind;
    BodyDescription& body =
        add_solid(scene, kind, cell * site, {0.03, is_round ? 0.03 : 0.04, 0.055});
    if (k % 7 == 0 && kind == shapes::Box::kind) {
      body.shape = shapes::Rounded::of(body.shape, 0.01);
      set_mass_from_density(body, 1000);
    }
    body.orientation = random_turn(random);
    body.velocity = 0.5 * normal_vector(random);
    body.angular_velocity = 5.0 * normal_vector(random);
  }
  return scene;
}

/// A star of five arms about y.
inline BodyDescription& add_star(Scene& scene, const Vec3d& x, double size) {
  std::vector<ShapePart> parts;
  for (int k = 0; k < 5; ++k) {
    const Quatd q = exp_map(Vec3d{0, 2 * physics::kPi * k / 5, 0});
    parts.push_back(
        part(box_of({0.5 * size, 0.1 * size, 0.15 * size}), rotate(q, Vec3d{0.5 * size, 0, 0}), q));
  }
  BodyDescription body;
  body.position = x;
  set_compound(scene, body, std::move(parts), SharedMass::each_part);
  set_mass_from_density(body, 1000);
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

/// All shapes, and stars, between walls of all kinds.
inline Scene bodies_among_walls() {
  constexpr double kCell = 0.15;
  Scene scene = every_shape(0.004, 4, kCell, 6);
  for (BodyDescription& body : scene.bodies) body.position -= 2 * kCell * Vec3d{1, 1, 1};
  scene.gravity = {0, 0, -1};
  add_room(scene, 0.45);
  physics::add_wall_box(scene, {0, 0, -0.4}, {0.2, 0.2, 0.04}).orientation =
      exp_map(Vec3d{0.1, 0.2, 0.3});
  physics::add_valley(scene).position = {0, 0, 0.37};
  add_star(scene, {0, 0, -0.33}, 0.02).angular_velocity = {1, 5, 2};
  return scene;
}

}  // namespace scree::test
