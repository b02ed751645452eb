#pragma once
// An upright cylinder of settled spheres, as high as its radius, that collapses when it is let go.

#include <algorithm>

#include "tests/physics/scene_builder.h"

namespace scree::physics {

/// Diameter of the grains [m]; a power of two, so that the radius is the same number
/// in float and double.
inline constexpr double kGrain = 1.0 / 128;

struct Column {
  std::vector<Vec3d> centers;  ///< [m], axis at x = y = 0, floor at z = 0
  double radius = 0;           ///< of the cylinder that the centers fill, equal to its height [m]
};

/// Settles a wider bed in a tank and cuts `count` spheres out of its middle.
/// @param seed  of the loose lattice that is settled: another seed, another packing
inline Column cut_column(int count, unsigned seed = 3) {
  // A cylinder of radius = height = R holds count grains at a solid fraction of 0.6.
  const double expected = std::cbrt(count * kPi / 6 / (0.6 * kPi)) * kGrain;
  const double side = 1.2 * expected;
  Scene scene = empty_scene(1e-3, 0.5);
  scene.precision = "double";
  scene.solver.stop = {StopRule::Level::quality, 0};
  scene.solver.max_iterations = 500;
  const double spacing = 1.08 * kGrain;
  const int across = static_cast<int>(2 * side / spacing);
  const int layers = static_cast<int>(1.9 * expected / kGrain);
  add_lattice(scene, layers * across * across, across, across,
              {-0.5 * (across - 1) * spacing, -0.5 * (across - 1) * spacing, 0.55 * kGrain},
              spacing, kGrain / 2, 2500, seed);
  add_tank(scene, -side, side, -side, side);
  World world(scene, cpu_options(0));
  run_for(world, scene, 0.3);

  std::vector<Vec3d> centers = world.states().position;
  centers.resize(static_cast<std::size_t>(layers * across * across));
  const auto extent = [](const Vec3d& x) { return std::max(std::hypot(x.x, x.y), x.z); };
  std::sort(centers.begin(), centers.end(),
            [&](const Vec3d& a, const Vec3d& b) { return extent(a) < extent(b); });
  Column column;
  column.radius = extent(centers[static_cast<std::size_t>(count - 1)]);
  column.centers.assign(centers.begin(), centers.begin() + count);
  return column;
}

/// The column at rest on a floor of glued grains, nothing holding it; bodies 0 to count - 1 are
/// the grains. On a smooth floor spheres roll on forever: nothing but friction at
/// a point would stop them.
inline Scene column_scene(const Column& column, double time_step) {
  Scene scene = empty_scene(time_step, 0.5);
  scene.solver.stop = {StopRule::Level::quality, 0};
  scene.solver.max_iterations = 500;
  for (const Vec3d& center : column.centers)
    set_mass_from_density(add_sphere(scene, center, kGrain / 2, 1), 2500);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> shift(-0.2, 0.2);
  for (int i = -25; i <= 25; ++i) {
    for (int j = -25; j <= 25; ++j) {
      const double x = i + shift(random), y = j + shift(random);
      add_sphere(scene, kGrain * Vec3d{x, y, -0.5}, kGrain / 2, 1).kind = BodyKind::fixed;
    }
  }
  add_plane(scene, {0, 0, 1}, {0, 0, -kGrain});
  return scene;
}

/// (r_end - r_0) / r_0 of a column that has come to rest. r_end holds the centers of 98 % of the
/// grains, so that a few stragglers do not count; it lies 8 % inside the edge of a cone.
inline double run_out(const Column& column, const std::vector<Vec3d>& positions) {
  const std::size_t count = column.centers.size();
  std::vector<double> radii;
  for (std::size_t i = 0; i < count; ++i)
    radii.push_back(std::hypot(positions[i].x, positions[i].y));
  std::sort(radii.begin(), radii.end());
  return radii[count * 98 / 100] / column.radius - 1;
}

}  // namespace scree::physics
