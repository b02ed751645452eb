// When a way first leaves its walls, against a dense search.

#include "host/variational/first_hit.h"

#include <gtest/gtest.h>

#include <random>

#include "host/collision_walls.h"
#include "host/error.h"

namespace scree::variational {
namespace {

/// A quadric, a union of a quadric and a half-space, or a plane body's corner, in three coordinates.
Wall random_wall(std::mt19937_64& random, int kind) {
  std::uniform_real_distribution<double> any(-1, 1);
  const auto quadric = [&] {
    const double a = any(random), b = any(random), c = any(random), d = any(random);
    return quadric_wall("quadric", {a, d, 0, d, b, d, 0, d, c},
                        {any(random), any(random), any(random)}, 0.5 + any(random));
  };
  if (kind == 0) return quadric();
  if (kind == 1) {
    Wall wall = quadric();
    wall.parts.push_back(
        half_space_wall("", {{any(random), any(random), any(random)}, any(random)}).parts[0]);
    return wall;
  }
  return plane_body_wall("corner", {.x = any(random), .y = any(random)}, any(random), any(random),
                         any(random));
}

Vector random_vector(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> any(-size, size);
  return Vector{{any(random), any(random), any(random)}};
}

double value_on(const Wall& wall, const Way& way, double s) {
  Vector q(3);
  way.place(s, q);
  return gap_at({&wall, 1}, q);
}

TEST(FirstHit, ComesBeforeAllOthers) {
  std::mt19937_64 random(11);
  int hits = 0, short_excursions = 0;
  for (int k = 0; k < 3000; ++k) {
    const Wall wall = random_wall(random, k % 3);
    const Way way{random_vector(random, 1), random_vector(random, 2), random_vector(random, 4), 1,
                  1};
    if (value_on(wall, way, 0) < 1e-3) continue;
    HitSearch search({&wall, 1}, 3, 64);
    const auto hit = search.first(way);
    // Nowhere before the hit is the wall crossed, and just behind it, it is.
    const double end = hit.value_or(1);
    const int count = 2000;
    double least = 1;
    for (int i = 0; i <= count; ++i) least = std::min(least, value_on(wall, way, end * i / count));
    ASSERT_GE(least, -1e-13) << k;
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(value_on(wall, way, *hit), 0, 1e-13) << k;
    short_excursions += value_on(wall, way, 1) > 0;
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(short_excursions, 50);  // a test of the end alone misses these
}

TEST(FirstHit, SamplesAgreeWithBounds) {
  std::mt19937_64 random(12);
  int hits = 0;
  for (int k = 0; k < 1000; ++k) {
    const Wall wall = random_wall(random, k % 3);
    Wall sampled = wall;
    for (WallFunction& part : sampled.parts) part.curvature.clear();
    const Way way{random_vector(random, 1), random_vector(random, 2), random_vector(random, 4), 1,
                  1};
    if (value_on(wall, way, 0) < 1e-3) continue;
    const auto a = HitSearch({&wall, 1}, 3, 64).first(way);
    const auto b = HitSearch({&sampled, 1}, 3, 64).first(way);
    ASSERT_EQ(a.has_value(), b.has_value()) << k;
    if (!a) continue;
    ++hits;
    EXPECT_NEAR(*a, *b, 1e-7) << k;
  }
  EXPECT_GT(hits, 200);
}

TEST(FirstHit, TheFirstOfSeveralWalls) {
  const std::vector<Wall> walls = {half_space_wall("far", {{-1, 0, 0}, -0.8}),
                                   half_space_wall("near", {{-1, 0, 0}, -0.3}),
                                   half_space_wall("behind", {{1, 0, 0}, -0.1})};
  const Way way{Vector::Zero(3), Vector{{1, 0, 0}}, Vector::Zero(3), 1, 1};
  EXPECT_DOUBLE_EQ(HitSearch(walls, 3, 64).first(way).value(), 0.3);
}

TEST(FirstHit, ValuesThatAreNotFiniteAreRefused) {
  Wall wall = half_space_wall("broken", {{1, 0, 0}, -1});
  wall.parts[0].value = [](std::span<const double>) { return std::nan(""); };
  const Way way{Vector::Zero(3), Vector{{1, 0, 0}}, Vector::Zero(3), 1, 1};
  EXPECT_THROW(HitSearch({&wall, 1}, 3, 64).first(way), RunError);
  wall.parts[0].curvature.clear();
  EXPECT_THROW(HitSearch({&wall, 1}, 3, 64).first(way), RunError);
}

}  // namespace
}  // namespace scree::variational
