#include "collision/mesh_seams.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace scree {
namespace {

using Vec = Vec3<double>;
constexpr double kMatch = 1e-6;  ///< of the size of the mesh

const Vec& at(const std::vector<Vec>& points, Index v) {
  return points[static_cast<std::size_t>(v)];
}
Index& at(std::vector<Index>& of, Index v) { return of[static_cast<std::size_t>(v)]; }
Index at(const std::vector<Index>& of, Index v) { return of[static_cast<std::size_t>(v)]; }

/// How far points reach along a direction [m].
struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  Extent(const std::vector<Vec>& points, const Vec& along) {
    for (const Vec& x : points)
      low = std::min(low, dot(x, along)), high = std::max(high, dot(x, along));
  }
};

/// Vertices near the plane at a height along a direction.
std::vector<Index> in_plane(const std::vector<Vec>& points, const Vec& along, double height,
                            double tolerance) {
  std::vector<Index> found;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (std::abs(dot(points[v], along) - height) <= tolerance)
      found.push_back(static_cast<Index>(v));
  return found;
}

/// Finds for the vertices of one end those of the other. @param shift  from that end to this one [m]
/// @param to  in the order of their coordinates along an axis
/// @return    false: there is none for one of them
bool match(const std::vector<Vec>& points, const std::vector<Index>& from,
           const std::vector<Index>& to, int axis, const Vec& shift, double tolerance,
           std::vector<Index>& other, double& mismatch) {
  for (const Index v : from) {
    const Vec wanted = at(points, v) - shift;
    double least = tolerance;
    auto u = std::lower_bound(
        to.begin(), to.end(), wanted[axis] - tolerance,
        [&](Index candidate, double x) { return at(points, candidate)[axis] < x; });
    for (; u != to.end() && at(points, *u)[axis] <= wanted[axis] + tolerance; ++u) {
      const double off = norm(at(points, *u) - wanted);
      if (off > least) continue;
      least = off;
      at(other, v) = *u;
    }
    if (at(other, v) < 0) return false;
    mismatch = std::max(mismatch, least);
  }
  return true;
}

/// Pairs the vertices of both ends. @return  false: one of them has no other
bool pair_ends(const std::vector<Vec>& points, std::vector<Index> lower, std::vector<Index> upper,
               double tolerance, MeshSeam& seam) {
  int axis = 0;  // along which they are spread most
  double widest = -1;
  for (int k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Index v : lower)
      low = std::min(low, at(points, v)[k]), high = std::max(high, at(points, v)[k]);
    if (high - low > widest) widest = high - low, axis = k;
  }
  for (std::vector<Index>* end : {&lower, &upper})
    std::sort(end->begin(), end->end(), [&](Index u, Index v) {
      return std::pair(at(points, u)[axis], u) < std::pair(at(points, v)[axis], v);
    });
  seam.before.assign(points.size(), -1);
  seam.after.assign(points.size(), -1);
  return match(points, upper, lower, axis, seam.period, tolerance, seam.before, seam.mismatch) &&
         match(points, lower, upper, axis, -seam.period, tolerance, seam.after, seam.mismatch);
}

/// Takes out the triangles that face the image of the mesh. @return  false: those of the ends differ, and all were kept
bool take_inner(const std::vector<Vec>& points, const MeshSeam& seam,
                std::vector<std::array<Index, 3>>& triangles) {
  double upper = 0, lower = 0;
  std::vector<std::array<Index, 3>> kept;
  for (const auto& t : triangles) {
    const auto all = [&](const std::vector<Index>& paired_with) {
      return std::all_of(t.begin(), t.end(), [&](Index v) { return at(paired_with, v) >= 0; });
    };
    const double out =
        dot(cross(at(points, t[1]) - at(points, t[0]), at(points, t[2]) - at(points, t[0])),
            seam.period);
    if (out > 0 && all(seam.before)) {
      upper += out;
    } else if (out < 0 && all(seam.after)) {
      lower -= out;
    } else {
      kept.push_back(t);
    }
  }
  if (std::abs(upper - lower) > kMatch * upper) return false;
  triangles = std::move(kept);
  return true;
}

}  // namespace

double diagonal_of(const std::vector<Vec3<double>>& points) {
  if (points.empty()) return 0;
  Vec low = points.front(), high = low;
  for (const Vec& x : points)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], x[k]), high[k] = std::max(high[k], x[k]);
  return norm(high - low);
}

std::vector<MeshSeam> take_seams(const std::vector<Vec3<double>>& points,
                                 std::vector<std::array<Index, 3>>& triangles, bool closed,
                                 const std::vector<Vec3<double>>& periods) {
  std::vector<MeshSeam> seams;
  const double tolerance = kMatch * diagonal_of(points);
  for (const Vec& period : periods) {
    const Vec along = normalized(period);
    const Extent extent(points, along);
    if (std::abs(extent.high - extent.low - norm(period)) > tolerance) continue;
    MeshSeam seam;
    seam.period = period;
    if (!pair_ends(points, in_plane(points, along, extent.low, tolerance),
                   in_plane(points, along, extent.high, tolerance), tolerance, seam))
      continue;
    if (closed && !take_inner(points, seam, triangles)) continue;
    seams.push_back(std::move(seam));
  }
  return seams;
}

}  // namespace scree
