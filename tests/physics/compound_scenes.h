#pragma once
// Bodies of several parts, and a pile of them.

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "host/compounds.h"
#include "host/hulls.h"
#include "tests/host/scene/shape_samples.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {

using test::ball_of;
using test::box_of;
using test::part;
using test::round_of;

inline BodyDescription& add_compound(Scene& scene, const Vec3d& position,
                                     std::vector<ShapePart> parts, BodyKind kind = BodyKind::free,
                                     SharedMass shared = SharedMass::once) {
  BodyDescription body;
  body.kind = kind;
  body.position = position;
  set_compound(scene, body, std::move(parts), shared);
  if (kind == BodyKind::free) set_mass_from_density(body, 1000);
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

/// Three balls in a row that overlap, along x.
inline std::vector<ShapePart> three_balls(double radius, double spacing) {
  return {part(ball_of(radius), {-spacing, 0, 0}), part(ball_of(radius), {}),
          part(ball_of(radius), {spacing, 0, 0})};
}
inline std::vector<ShapePart> cross_of_bars(double half, double thick) {
  return {part(box_of({half, thick, thick}), {}), part(box_of({thick, half, thick}), {}),
          part(box_of({thick, thick, half}), {})};
}

/// A ball cut in halves, as pieces of a free mesh are; the halves reach farther about their centers than the ball.
inline std::vector<ShapePart> two_halves(Scene& scene, double radius) {
  std::vector<ShapePart> parts;
  for (const double side : {-1.0, 1.0}) {
    std::vector<Vec3d> points;
    for (int k = 0; k < 8; ++k)
      for (const double height : {0.0, 0.7})
        points.push_back({side * radius * height,
                          radius * std::sqrt(1 - height * height) * std::cos(kPi * k / 4),
                          radius * std::sqrt(1 - height * height) * std::sin(kPi * k / 4)});
    BodyDescription half;
    set_hull(scene, half, points);
    parts.push_back(part(half.shape, half.position, half.orientation));
  }
  return parts;
}

/// Compounds of balls, bars and round shapes, balls and boxes over a tank.
inline Scene pile_of_compounds() {
  Scene scene = empty_scene(2e-3, 0.5);
  scene.stepping.skin = -1;
  solve_to(scene, 1e-6);
  scene.solver.max_iterations = 400;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int layer = 0; layer < 4; ++layer)
    for (int k = 0; k < 9; ++k) {
      const Vec3d site{0.17 * (k % 3 - 1), 0.17 * (k / 3 - 1), 0.12 + 0.17 * layer};
      BodyDescription body;
      body.position = site;
      const double a = u(random), b = u(random), c = u(random);
      body.orientation = exp_map(Vec3d{a, b, c});
      switch ((k + layer) % 4) {
        case 0:
          set_compound(scene, body, three_balls(0.04, 0.03));
          break;
        case 1:
          set_compound(scene, body, cross_of_bars(0.07, 0.02));
          break;
        case 2:
          set_compound(
              scene, body,
              {part(round_of("cylinder", 0.015, 0.06), {}), part(ball_of(0.03), {0, 0, 0.05}),
               part(round_of("cone", 0.03, 0.04), {0, 0, -0.04})},
              SharedMass::each_part);
          break;
        default:
          body.shape = k % 2 == 0 ? ball_of(0.05) : box_of({0.05, 0.04, 0.03});
      }
      set_mass_from_density(body, 1000);
      scene.bodies.push_back(body);
    }
  add_tank(scene, -0.28, 0.28, -0.28, 0.28);
  return scene;
}

}  // namespace scree::physics
