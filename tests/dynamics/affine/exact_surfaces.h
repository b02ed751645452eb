#pragma once
// Whether surfaces of a run of affine bodies touch, without rounding.

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <numeric>
#include <vector>

#include "dynamics/affine/affine_setup.h"
#include "host/world.h"
#include "kernels/affine/surface_tree.h"
#include "tests/exact_triangles.h"

namespace scree::affine {

/// Where the bodies of a run are, by body. @param setup  of the scene of the run
inline std::vector<AffineVec> places_of(const AffineSetup& setup, World& world) {
  const std::vector<Vec3d> nodes = world.save().at<Vec3d>("affine/position");  // four a row
  std::vector<AffineVec> places = setup.position;
  for (std::size_t b = 0; b < places.size(); ++b)
    if (setup.bodies[b].row >= 0)
      for (std::size_t n = 0; n < 4; ++n)
        places[b].node[n] = nodes[4 * static_cast<std::size_t>(setup.bodies[b].row) + n];
  return places;
}

/// The triangles of a body where it is, and a box about each.
struct PlacedTriangles {
  std::vector<exact::Triangle> triangles;
  std::vector<Bounds> boxes;
  Bounds all;

  PlacedTriangles() = default;
  PlacedTriangles(const Surface& surface, const AffineVec& place) {
    for (const auto& t : surface.triangles) {
      exact::Triangle corners;
      Bounds box;
      for (std::size_t c = 0; c < 3; ++c) {
        corners[c] = point_of(place, surface.vertices[static_cast<std::size_t>(t[c])]);
        box.add(corners[c]);
      }
      triangles.push_back(corners);
      boxes.push_back(box);
      all.add(box);
    }
  }

  /// Numbers of those whose boxes meet another, from the least x on.
  std::vector<std::size_t> meeting(const Bounds& other) const {
    std::vector<std::size_t> found;
    for (std::size_t t = 0; t < boxes.size(); ++t)
      if (boxes[t].near(other, 0)) found.push_back(t);
    std::sort(found.begin(), found.end(),
              [&](std::size_t s, std::size_t t) { return boxes[s].low.x < boxes[t].low.x; });
    return found;
  }
};

/// Whether a triangle has an area, without rounding.
inline bool has_area(const exact::Triangle& t) {
  const Vec3d a = t[1] - t[0], b = t[2] - t[0];
  if (norm(cross(a, b)) > 1e-12 * norm(a) * norm(b)) return true;
  const auto axes = exact::plane_axes(t);
  return axes[0] != axes[1];
}

/// Whether two triangles have a point in common. One without area counts by its edges, which two such are not tried for.
inline bool surfaces_meet(const exact::Triangle& s, const exact::Triangle& t) {
  const bool has_s = has_area(s), has_t = has_area(t);
  if (has_s && has_t) return exact::triangles_touch(s, t);
  if (!has_s && !has_t) return false;
  const exact::Triangle &line = has_s ? t : s, &plane = has_s ? s : t;
  for (std::size_t k = 0; k < 3; ++k)
    if (exact::segment_touches(line[k], line[(k + 1) % 3], plane)) return true;
  return false;
}

inline bool any_meet(const PlacedTriangles& a, const PlacedTriangles& b) {
  const std::vector<std::size_t> of_a = a.meeting(b.all), of_b = b.meeting(a.all);
  const auto meets_one = [](const PlacedTriangles& own, std::size_t s, const PlacedTriangles& other,
                            const std::vector<std::size_t>& order, std::size_t from) {
    for (std::size_t k = from; k < order.size(); ++k) {
      const std::size_t t = order[k];
      if (other.boxes[t].low.x > own.boxes[s].high.x) return false;
      if (own.boxes[s].near(other.boxes[t], 0) &&
          surfaces_meet(own.triangles[s], other.triangles[t]))
        return true;
    }
    return false;
  };
  std::size_t i = 0, j = 0;  // whichever begins first meets those that begin before it ends
  while (i < of_a.size() && j < of_b.size()) {
    if (a.boxes[of_a[i]].low.x <= b.boxes[of_b[j]].low.x) {
      if (meets_one(a, of_a[i++], b, of_b, j)) return true;
    } else if (meets_one(b, of_b[j++], a, of_a, i)) {
      return true;
    }
  }
  return false;
}

/// Calls f(k) for k below `count`, on so many threads.
template <class F>
void for_all(std::size_t count, int threads, const F& f) {
  const auto stride = static_cast<std::size_t>(threads);
  std::vector<std::future<void>> others;
  const auto share = [&](std::size_t first) {
    for (std::size_t k = first; k < count; k += stride) f(k);
  };
  for (std::size_t first = 1; first < stride; ++first)
    others.push_back(std::async(std::launch::async, share, first));
  share(0);
  for (std::future<void>& other : others) other.get();
}

/// Pairs of bodies that may touch and whose triangles have a point in common. Tetrahedra of one elastic body do not count.
inline std::vector<std::array<Index, 2>> touching_bodies(const AffineSetup& setup,
                                                         const std::vector<AffineVec>& places,
                                                         int threads = 1) {
  std::vector<PlacedTriangles> placed(places.size());
  for_all(places.size(), threads, [&](std::size_t b) {
    placed[b] = PlacedTriangles(*setup.surfaces[static_cast<std::size_t>(setup.surface_of_body[b])],
                                places[b]);
  });
  std::vector<std::size_t> order(places.size());  // along x
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return placed[a].all.low.x < placed[b].all.low.x;
  });
  std::vector<std::array<std::size_t, 2>> near;
  for (auto i = order.begin(); i != order.end(); ++i) {
    for (auto k = i + 1; k != order.end() && placed[*k].all.low.x <= placed[*i].all.high.x; ++k) {
      const auto [a, b] = std::minmax(*i, *k);
      if (placed[a].all.near(placed[b].all, 0) && setup.id_of_body[a] != setup.id_of_body[b] &&
          may_touch(setup, static_cast<Index>(a), static_cast<Index>(b)))
        near.push_back({a, b});
    }
  }
  std::vector<char> meet(near.size());
  for_all(near.size(), threads,
          [&](std::size_t k) { meet[k] = any_meet(placed[near[k][0]], placed[near[k][1]]); });
  std::vector<std::array<Index, 2>> found;
  for (std::size_t k = 0; k < near.size(); ++k)
    if (meet[k] != 0)
      found.push_back({static_cast<Index>(near[k][0]), static_cast<Index>(near[k][1])});
  return found;
}

/// Whether triangles of two bodies of the scene have a point in common. @param setup  of the scene of the run
inline bool triangles_touch(const AffineSetup& setup, World& world) {
  return !touching_bodies(setup, places_of(setup, world)).empty();
}

}  // namespace scree::affine
