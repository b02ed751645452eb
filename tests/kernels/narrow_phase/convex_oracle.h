#pragma once
// Distances and depths of convex bodies by other means than those of the project: projections, and a
// search over directions.

#include <algorithm>
#include <random>
#include <vector>

#include "kernels/narrow_phase/pairs/pair_side.h"

namespace scree {

inline PairSide ball(double radius) { return {radius, {}, {}, kNoShape, {}}; }

/// Lists contacts with gaps up to a reach [m].
struct IsWithin {
  double reach;
  SCREE_HD bool operator()(const ContactGeometry& g) const { return g.gap <= reach; }
};

/// A box, or a body with one about it.
struct PosedBody {
  Vec3d center;
  Quatd q;
  Vec3d half;

  PairSide side() const { return {0, q, half, kNoShape, {}}; }
};

inline Vec3d nearest_in_box(const PosedBody& box, const Vec3d& x) {
  Vec3d local = rotate_back(box.q, x - box.center);
  for (int k = 0; k < 3; ++k) local[k] = std::clamp(local[k], -box.half[k], box.half[k]);
  return box.center + rotate(box.q, local);
}

inline std::vector<Vec3d> corners(const PosedBody& box) {
  std::vector<Vec3d> out;
  for (const double x : {-1, 1})
    for (const double y : {-1, 1})
      for (const double z : {-1, 1})
        out.push_back(box.center + rotate(box.q, hadamard(box.half, Vec3d{x, y, z})));
  return out;
}

/// How far the hulls of points overlap in a direction: what A must be moved against it to be free of B.
inline double overlap_along(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b,
                            const Vec3d& n) {
  double top = -1e300, bottom = 1e300;
  for (const Vec3d& x : a) top = std::max(top, dot(x, n));
  for (const Vec3d& x : b) bottom = std::min(bottom, dot(x, n));
  return top - bottom;
}

inline Vec3d any_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random);
  return {x, y, normal(random)};
}

/// The least overlap of all directions: sampled, then improved by smaller and smaller turns.
/// @param overlap  overlap(n): of the bodies along a unit vector [m]
template <class Overlap>
double least_of_directions(Overlap&& overlap, int starts, std::mt19937& random) {
  double least = 1e300;
  for (int start = 0; start < starts; ++start) {
    Vec3d n = normalized(any_vector(random));
    double found = overlap(n);
    for (double step = 0.5; step > 1e-5; step *= 0.8) {
      for (int k = 0; k < 12; ++k) {
        const Vec3d turned = normalized(n + step * any_vector(random));
        const double next = overlap(turned);
        if (next < found) found = next, n = turned;
      }
    }
    least = std::min(least, found);
  }
  return least;
}

inline double sampled_depth(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b,
                            std::mt19937& random) {
  return least_of_directions([&](const Vec3d& n) { return overlap_along(a, b, n); }, 30, random);
}

}  // namespace scree
