#include "tests/affine_reference/pair_search.h"

#include <algorithm>

namespace scree::affine {
namespace {

struct Box {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  void add(const Vec3d& x) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], x[k]);
      high[k] = std::max(high[k], x[k]);
    }
  }
  void add(const Box& o) {
    add(o.low);
    add(o.high);
  }
  bool near(const Box& o, double distance) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > o.high[k] + distance || o.low[k] > high[k] + distance) return false;
    return true;
  }
};

/// Boxes of the parts of a body over its way, and of all of it.
struct BodyBoxes {
  std::vector<Box> vertices, edges, triangles;
  Box all;

  BodyBoxes(const Surface& surface, const AffineVec& from, const AffineVec& to) {
    for (const Vec3d& rest : surface.vertices) {
      Box box;
      box.add(point_of(from, rest));
      box.add(point_of(to, rest));
      vertices.push_back(box);
      all.add(box);
    }
    const auto about = [&](const auto& corners) {
      Box box;
      for (const int v : corners) box.add(vertices[static_cast<std::size_t>(v)]);
      return box;
    };
    for (const auto& e : surface.edges) edges.push_back(about(e));
    for (const auto& t : surface.triangles) triangles.push_back(about(t));
  }
};

/// Numbers of the boxes that are near another.
std::vector<std::size_t> near(const std::vector<Box>& boxes, const Box& other, double distance) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < boxes.size(); ++k)
    if (boxes[k].near(other, distance)) found.push_back(k);
  return found;
}

}  // namespace

Four rest_points(const std::vector<AffineBody>& bodies, const SurfacePair& pair) {
  const Surface &first = *bodies[static_cast<std::size_t>(pair.body[0])].surface,
                &second = *bodies[static_cast<std::size_t>(pair.body[1])].surface;
  const int split = first_points(pair.kind);
  Four rest;
  for (int i = 0; i < 4; ++i) {
    const int vertex = pair.vertex[static_cast<std::size_t>(i)];
    rest[i] = (i < split ? first : second).vertices[static_cast<std::size_t>(vertex)];
  }
  return rest;
}

// Bodies are taken before the loop: g++ 12.2 reads beside the array where it makes a choice of indices
// within the loop into gathers of AVX-512.
Four points_of(const std::vector<AffineVec>& q, const SurfacePair& pair, const Four& rest) {
  const AffineVec &first = q[static_cast<std::size_t>(pair.body[0])],
                  &second = q[static_cast<std::size_t>(pair.body[1])];
  const int split = first_points(pair.kind);
  Four x;
  for (int i = 0; i < 4; ++i) x[i] = point_of(i < split ? first : second, rest[i]);
  return x;
}

std::vector<SurfacePair> pairs_near(const std::vector<AffineBody>& bodies,
                                    const std::vector<AffineVec>& from,
                                    const std::vector<AffineVec>& to, double distance,
                                    const std::function<bool(int, int)>& may_touch) {
  std::vector<BodyBoxes> boxes;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    boxes.emplace_back(*bodies[b].surface, from[b], to[b]);
  std::vector<SurfacePair> found;
  const auto points_on_triangles = [&](std::size_t a, std::size_t b) {
    const auto triangles = near(boxes[b].triangles, boxes[a].all, distance);
    for (const std::size_t v : near(boxes[a].vertices, boxes[b].all, distance)) {
      for (const std::size_t t : triangles) {
        if (!boxes[a].vertices[v].near(boxes[b].triangles[t], distance)) continue;
        const auto& corners = bodies[b].surface->triangles[t];
        found.push_back({PairKind::point_triangle,
                         {static_cast<int>(a), static_cast<int>(b)},
                         {static_cast<int>(v), corners[0], corners[1], corners[2]}});
      }
    }
  };
  for (std::size_t a = 0; a < bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      if (bodies[a].fixed && bodies[b].fixed) continue;
      if (!boxes[a].all.near(boxes[b].all, distance)) continue;
      if (may_touch && !may_touch(static_cast<int>(a), static_cast<int>(b))) continue;
      points_on_triangles(a, b);
      points_on_triangles(b, a);
      const auto others = near(boxes[b].edges, boxes[a].all, distance);
      for (const std::size_t e : near(boxes[a].edges, boxes[b].all, distance)) {
        for (const std::size_t f : others) {
          if (!boxes[a].edges[e].near(boxes[b].edges[f], distance)) continue;
          const auto &own = bodies[a].surface->edges[e], &other = bodies[b].surface->edges[f];
          found.push_back({PairKind::edge_edge,
                           {static_cast<int>(a), static_cast<int>(b)},
                           {own[0], own[1], other[0], other[1]}});
        }
      }
    }
  }
  return found;
}

}  // namespace scree::affine
