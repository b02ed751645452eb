#pragma once
// What solids are added up from for their mass properties.

#include <array>

#include "shapes/polyhedron.h"

namespace scree {

/// Integrals over a solid of density one: of 1, x_i and x_i x_j.
struct SolidSums {
  double volume = 0;
  Vec3d first;
  std::array<std::array<double, 3>, 3> second{};

  void add(int i, int j, double value) {
    second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] += value;
  }
  /// @param sign  -1 takes it away
  void add(const SolidSums& o, double sign) {
    volume += sign * o.volume;
    first += sign * o.first;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        add(i, j, sign * o.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
  }
  /// Adds s (a b^T + b a^T) / 2.
  void add_second(double s, const Vec3d& a, const Vec3d& b) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) add(i, j, 0.5 * s * (a[i] * b[j] + b[i] * a[j]));
  }
  /// Adds a piece at a point, of which integrals about that point are given but for those of x_i x_j.
  void add_at(const Vec3d& point, double piece, const Vec3d& piece_first) {
    volume += piece;
    first += piece * point + piece_first;
    add_second(piece, point, point);
    add_second(2, point, piece_first);
  }
  SolidMoments moments() const {
    SolidMoments m;
    m.volume = volume;
    m.center = (1 / volume) * first;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const auto r = static_cast<std::size_t>(i), c = static_cast<std::size_t>(j);
        m.second[r][c] = second[r][c] / volume - m.center[i] * m.center[j];
      }
    return m;
  }
};

}  // namespace scree
