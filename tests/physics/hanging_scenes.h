#pragma once
// Many small bodies on joints that hang: a chain, a net.

#include <cmath>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {

inline constexpr double kLink = 0.03;

/// Links between two hooks, on an arc: it is no line of equilibrium, so the chain swings.
inline Scene hanging_chain(int links) {
  constexpr double kHalfAngle = 1;
  Scene scene = empty_scene(1e-3, 0);
  scene.solver.stop = StopRule();
  const double angle = 2 * kHalfAngle / links;
  const double radius = 0.5 * kLink / std::sin(angle / 2);
  const auto at = [&](int k) {
    const double turn = -kHalfAngle + angle * k;
    return Vec3d{radius * std::sin(turn), 0, -radius * std::cos(turn)};
  };
  for (int k = 0; k < links; ++k) {
    BodyDescription& link =
        add_box(scene, 0.5 * (at(k) + at(k + 1)), {kLink / 2, 0.004, 0.004}, 0.01);
    link.orientation = exp_map(Vec3d{0, kHalfAngle - angle * (k + 0.5), 0});
    scene.joints.push_back(joint_of(JointKind::ball, k - 1, k, at(k)));
  }
  scene.joints[0].bodies[0] = kWorldBody;
  scene.joints.push_back(joint_of(JointKind::ball, links - 1, kWorldBody, at(links)));
  return scene;
}

/// Knots in a square, held at the rim; rods between neighbors. It sags from there.
inline Scene hanging_net(int knots) {
  constexpr double kSpacing = 0.027;
  const double zigzag = std::sqrt(kLink * kLink - kSpacing * kSpacing) / 2;
  Scene scene = empty_scene(5e-4, 0);
  scene.solver.stop = StopRule();
  const auto at = [&](int i, int j) {
    return Vec3d{i * kSpacing, j * kSpacing, (i + j) % 2 == 0 ? zigzag : -zigzag};
  };
  const auto id = [&](int i, int j) { return i * knots + j; };
  for (int i = 0; i < knots; ++i)
    for (int j = 0; j < knots; ++j) {
      add_sphere(scene, at(i, j), 0.004, 0.002);
      const bool is_rim = i == 0 || i == knots - 1 || j == 0 || j == knots - 1;
      if (is_rim) scene.joints.push_back(joint_of(JointKind::ball, kWorldBody, id(i, j), at(i, j)));
      if (i > 0)
        scene.joints.push_back(
            line_of(JointKind::distance, id(i - 1, j), id(i, j), at(i - 1, j), at(i, j)));
      if (j > 0)
        scene.joints.push_back(
            line_of(JointKind::distance, id(i, j - 1), id(i, j), at(i, j - 1), at(i, j)));
    }
  return scene;
}

}  // namespace scree::physics
