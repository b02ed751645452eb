#pragma once
// What the search for near pairs must find, by the boxes of all features of all bodies on the host.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "dynamics/affine/near_pairs.h"
#include "solvers/solver.h"
#include "tests/affine_reference/pair_search.h"

namespace scree::affine {

/// Bodies, kind, and four corners in their surfaces.
using NamedPair = std::array<int, 7>;

/// Bodies with their surfaces, as SurfaceTables takes them.
struct SearchedBodies {
  const std::vector<std::shared_ptr<const Surface>>& surfaces;
  const std::vector<int>& surface;  ///< by body
  const std::vector<int>& group;
  const std::vector<std::array<int, 2>>& held;

  bool may_touch(std::size_t a, std::size_t b) const {
    if (group[a] >= 0 && group[a] == group[b]) return false;
    const int low = static_cast<int>(std::min(a, b)), high = static_cast<int>(std::max(a, b));
    return std::none_of(held.begin(), held.end(), [&](const auto& h) {
      return std::min(h[0], h[1]) == low && std::max(h[0], h[1]) == high;
    });
  }
};

/// The lists of a search in their order, which must be what NearPairsView says.
template <class B>
std::vector<NamedPair> named_pairs(B& b, const NearPairsView& view, const SearchedBodies& of) {
  const std::vector<NearPair> pairs = download(b, view.pairs);
  const std::vector<BodyPair> bodies = download(b, view.bodies);
  const std::vector<Vec3d> corners = download(b, view.corners);
  std::vector<int> first{0};
  for (const auto& s : of.surfaces)
    first.push_back(first.back() + static_cast<int>(s->vertices.size()));
  std::vector<NamedPair> all;
  std::size_t next = 0;
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    EXPECT_LT(bodies[p].body[0], bodies[p].body[1]);
    if (p > 0) {
      EXPECT_LT(std::pair(bodies[p - 1].body[0], bodies[p - 1].body[1]),
                std::pair(bodies[p].body[0], bodies[p].body[1]));
    }
    EXPECT_EQ(static_cast<std::size_t>(bodies[p].begin), next);
    EXPECT_LT(bodies[p].begin, bodies[p].end);
    next = static_cast<std::size_t>(bodies[p].end);
    for (Index k = bodies[p].begin; k < bodies[p].end; ++k) {
      const NearPair& pair = pairs[static_cast<std::size_t>(k)];
      EXPECT_EQ(static_cast<std::size_t>(pair.bodies), p);
      const int side = pair.is_swapped ? 1 : 0;
      NamedPair name{bodies[p].body[side], bodies[p].body[1 - side], static_cast<int>(pair.kind)};
      for (std::size_t i = 0; i < 4; ++i) {
        const int body = name[static_cast<int>(i) < first_points(pair.kind) ? 0 : 1];
        const auto surface = static_cast<std::size_t>(of.surface[static_cast<std::size_t>(body)]);
        name[3 + i] = pair.vertex[i] - first[surface];
        EXPECT_TRUE(corners[static_cast<std::size_t>(pair.vertex[i])] ==
                    of.surfaces[surface]->vertices[static_cast<std::size_t>(name[3 + i])]);
      }
      all.push_back(name);
    }
  }
  EXPECT_EQ(next, pairs.size());
  return all;
}

/// What a search must list, and what it may, sorted.
struct ExpectedPairs {
  std::vector<NamedPair> least;  ///< come within the distance themselves at one of nine times
  std::vector<NamedPair> most;   ///< those whose boxes do
  double gap = 1e300;            ///< least distance at the end [m]
};

/// Of bodies that may touch and go straight from one place to another.
inline ExpectedPairs expected_pairs(const SearchedBodies& of, const std::vector<AffineVec>& from,
                                    const std::vector<AffineVec>& to, double distance) {
  std::vector<AffineBody> bodies(of.surface.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    bodies[b].surface = of.surfaces[static_cast<std::size_t>(of.surface[b])];
  ExpectedPairs expected;
  const auto may_touch = [&](int a, int b) {
    return of.may_touch(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  };
  for (const SurfacePair& p : pairs_near(bodies, from, to, distance, may_touch)) {
    const NamedPair name{p.body[0],   p.body[1],   static_cast<int>(p.kind),
                         p.vertex[0], p.vertex[1], p.vertex[2],
                         p.vertex[3]};
    expected.most.push_back(name);
    const Four rest = rest_points(bodies, p);
    const Four start = points_of(from, p, rest), end = points_of(to, p, rest);
    bool comes_near = false;
    for (int k = 0; k <= 8; ++k) {
      if (comes_near && k < 8) continue;
      Four x;
      for (int i = 0; i < 4; ++i) x[i] = start[i] + k / 8.0 * (end[i] - start[i]);
      const double apart = std::sqrt(nearest_points(p.kind, x).squared);
      comes_near = comes_near || apart <= distance;
      if (k == 8) expected.gap = std::min(expected.gap, apart);
    }
    if (comes_near) expected.least.push_back(name);
  }
  std::sort(expected.least.begin(), expected.least.end());
  std::sort(expected.most.begin(), expected.most.end());
  return expected;
}

/// All that come near are listed once, and none whose boxes do not.
inline void expect_pairs(std::vector<NamedPair> found, const ExpectedPairs& expected) {
  std::sort(found.begin(), found.end());
  EXPECT_TRUE(std::adjacent_find(found.begin(), found.end()) == found.end());
  EXPECT_TRUE(
      std::includes(found.begin(), found.end(), expected.least.begin(), expected.least.end()));
  EXPECT_TRUE(
      std::includes(expected.most.begin(), expected.most.end(), found.begin(), found.end()));
}

}  // namespace scree::affine
