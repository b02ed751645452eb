#pragma once
// Terrain from grids of heights, and how high it is somewhere.

#include <cmath>
#include <cstddef>
#include <limits>

#include "host/scene/height_field.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {

/// Heights z(x, y) over a rectangle about the origin.
template <class Height>
HeightGrid grid_of(std::size_t columns, std::size_t rows, double lx, double ly, Height z) {
  HeightGrid grid{rows, columns, {}};
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) {
      const double x = lx * (static_cast<double>(c) / static_cast<double>(columns - 1) - 0.5);
      const double y = ly * (0.5 - static_cast<double>(r) / static_cast<double>(rows - 1));
      grid.heights.push_back(z(x, y));
    }
  return grid;
}

inline BodyDescription& add_field(Scene& scene, const HeightGrid& grid, double lx, double ly,
                                  double thickness = 0.1) {
  return add_mesh(scene, height_field_mesh("heights", grid, {lx, ly}, thickness));
}

/// How high the surface is, each cell of which is cut along its shorter diagonal; beyond its rim infinite [m].
inline double height_of(const HeightGrid& grid, double lx, double ly, double x, double y) {
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  const double u = (x / lx + 0.5) * static_cast<double>(grid.columns - 1);
  const double v = (y / ly + 0.5) * static_cast<double>(grid.rows - 1);
  if (!(u >= 0 && v >= 0)) return kBeyond;
  const auto i = static_cast<std::size_t>(u), j = static_cast<std::size_t>(v);
  if (i + 1 >= grid.columns || j + 1 >= grid.rows) return kBeyond;
  const double s = u - static_cast<double>(i), t = v - static_cast<double>(j);
  const double a = grid.at(i, j), b = grid.at(i + 1, j), c = grid.at(i + 1, j + 1),
               d = grid.at(i, j + 1);
  const double along_ac = s >= t ? a + s * (b - a) + t * (c - b) : a + t * (d - a) + s * (c - d);
  const double along_bd =
      s + t <= 1 ? a + s * (b - a) + t * (d - a) : c + (1 - s) * (d - c) + (1 - t) * (b - c);
  return std::abs(c - a) <= std::abs(d - b) ? along_ac : along_bd;
}

/// Whether a point is above the surface; one beyond its rim is not.
inline bool is_above(const HeightGrid& grid, double lx, double ly, const Vec3d& x) {
  return x.z > height_of(grid, lx, ly, x.x, x.y);
}

}  // namespace scree::physics
