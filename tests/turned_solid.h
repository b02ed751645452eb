#pragma once
// Meshes of solids of revolution.

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "shapes/shape.h"

namespace scree::test {

/// A point of a profile: distance from the axis and height [m].
using ProfilePoint = std::array<double, 2>;

/// Turned about z in so many sectors. A profile is a loop, or goes from pole to pole on the axis, upwards.
inline TriangleMesh turned_solid(const std::vector<ProfilePoint>& profile, int around) {
  TriangleMesh m;
  const int count = static_cast<int>(profile.size());
  std::vector<std::vector<int>> at(static_cast<std::size_t>(count));
  for (int j = 0; j < count; ++j) {
    const auto [r, z] = profile[static_cast<std::size_t>(j)];
    for (int i = 0; i < around; ++i) {
      if (r == 0 && i > 0) {
        at[static_cast<std::size_t>(j)].push_back(at[static_cast<std::size_t>(j)][0]);
        continue;
      }
      const double a = 2 * std::numbers::pi * i / around;
      at[static_cast<std::size_t>(j)].push_back(static_cast<int>(m.vertices.size()));
      m.vertices.push_back({r * std::cos(a), r * std::sin(a), z});
    }
  }
  const bool is_loop = profile.front()[0] != 0;
  for (int j = 0; j + (is_loop ? 0 : 1) < count; ++j) {
    const auto &low = at[static_cast<std::size_t>(j)],
               &high = at[static_cast<std::size_t>((j + 1) % count)];
    for (std::size_t i = 0; i < low.size(); ++i) {
      const std::size_t next = (i + 1) % low.size();
      if (low[i] != low[next]) m.triangles.push_back({low[i], low[next], high[next]});
      if (high[i] != high[next]) m.triangles.push_back({low[i], high[next], high[i]});
    }
  }
  return m;
}

}  // namespace scree::test
