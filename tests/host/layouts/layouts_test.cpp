#include "host/layouts/layouts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree {
namespace {

constexpr double kRounding = 1e-12;

Region unit_box() {
  Region region;
  region.upper = {1, 1, 1};
  return region;
}
Region tilted_cylinder() {
  Region region;
  region.kind = Region::Kind::cylinder;
  region.axis = normalized(Vec3d{1, 2, 3});
  region.center = {1, 1, 1};
  region.radius = 0.6;
  region.length = 2;
  return region;
}
RadiusLaw constant(double r) {
  RadiusLaw law;
  law.low = law.high = r;
  return law;
}
RadiusLaw uniform(double low, double high) {
  RadiusLaw law;
  law.kind = RadiusLaw::Kind::uniform;
  law.low = low;
  law.high = high;
  return law;
}

/// By brute force: no two spheres overlap, and all lie in the region.
void expect_clear(const PlacedSpheres& spheres, const Region& region) {
  const std::vector<Vec3d>& x = spheres.center;
  const PerParticle<double>& r = spheres.radius;
  ASSERT_TRUE(r.fits(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_TRUE(region.contains(x[i], r[i] - kRounding)) << i;
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE(norm(x[i] - x[j]), r[i] + r[j] - kRounding) << i << " and " << j;
  }
}

TEST(RandomNumbers, AreTheSameOnEveryPlatform) {
  // Recorded values: a change here changes every scene that draws numbers.
  RandomNumbers random(1, 0);
  EXPECT_EQ(random.unit(), 0x1.109f48cd2b63p-1);
  EXPECT_EQ(random.unit(), 0x1.c90fc93c4f5b7p-1);
  EXPECT_EQ(random.normal(), 0x1.bbb94362af2p-1);
  EXPECT_NE(RandomNumbers(1, 1).unit(), 0x1.109f48cd2b63p-1);
  EXPECT_NE(RandomNumbers(2, 0).unit(), 0x1.109f48cd2b63p-1);
}

TEST(RandomNumbers, HaveTheirMoments) {
  RandomNumbers random(3, 0);
  constexpr int count = 200000;
  double sum = 0;
  double square = 0;
  double fourth = 0;
  double uniform_sum = 0;
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
    uniform_sum += random.uniform(2, 4);
  }
  EXPECT_NEAR(sum / count, 0, 0.01);
  EXPECT_NEAR(square / count, 1, 0.02);
  EXPECT_NEAR(fourth / count, 3, 0.1);
  EXPECT_NEAR(uniform_sum / count, 3, 0.01);
}

TEST(RadiusLaw, DrawsWithinItsRange) {
  RandomNumbers random(1, 0);
  RadiusLaw normal = uniform(0.9, 1.3);
  normal.kind = RadiusLaw::Kind::normal;
  normal.mean = 1;
  normal.deviation = 0.2;
  RadiusLaw discrete;
  discrete.kind = RadiusLaw::Kind::discrete;
  discrete.values = {1, 2, 3};
  discrete.weights = {1, 0, 3};
  int small = 0;
  for (int i = 0; i < 10000; ++i) {
    const double n = normal.draw(random);
    EXPECT_TRUE(n >= 0.9 && n <= 1.3);
    const double d = discrete.draw(random);
    EXPECT_NE(d, 2);
    small += d == 1;
  }
  EXPECT_NEAR(small, 2500, 200);
  EXPECT_EQ(discrete.largest(), 3);
  EXPECT_EQ(normal.largest(), 1.3);
}

TEST(RadiusLaw, DrawsFromANarrowRangeOfAWideLaw) {
  RandomNumbers random(1, 0);
  RadiusLaw law = uniform(0.999, 1.001);
  law.kind = RadiusLaw::Kind::normal;
  law.mean = 1;
  law.deviation = 1e12;
  double sum = 0;
  for (int i = 0; i < 10000; ++i) {
    const double r = law.draw(random);
    ASSERT_TRUE(r >= 0.999 && r <= 1.001);
    sum += r;
  }
  EXPECT_NEAR(sum / 10000, 1, 3e-5);  // five times the error of the mean
  law.low = law.high = 1;
  EXPECT_EQ(law.draw(random), 1);
}

/// On both sides of the width from which draws are made another way, the share of the lower half
/// is that of the normal distribution.
TEST(RadiusLaw, NarrowAndWideRangesFollowTheSameLaw) {
  constexpr int count = 200000;
  for (const double width : {0.0999, 0.1001}) {
    RandomNumbers random(5, 0);
    RadiusLaw law = uniform(1.0, 1.0 + width);
    law.kind = RadiusLaw::Kind::normal;
    law.mean = 1;
    law.deviation = 1;
    int lower = 0;
    for (int i = 0; i < count; ++i) lower += law.draw(random) < 1 + width / 2;
    const double share = std::erf(width / 2 / std::sqrt(2.0)) / std::erf(width / std::sqrt(2.0));
    EXPECT_NEAR(static_cast<double>(lower) / count, share, 5 * std::sqrt(0.25 / count)) << width;
  }
}

TEST(Region, BoundsOfATiltedCylinderAreTight) {
  Region region;
  region.kind = Region::Kind::cylinder;
  region.axis = {1, 0, 0};
  region.radius = 2;
  region.length = 6;
  Vec3d low;
  Vec3d high;
  region.bounds(low, high);
  EXPECT_EQ(low, Vec3d(-3, -2, -2));
  EXPECT_EQ(high, Vec3d(3, 2, 2));
}

TEST(Lattice, FillsABoxExactly) {
  RandomNumbers random(1, 0);
  LatticeLayout layout{unit_box(), 0.1, 0};
  const auto all = place_on_lattice(layout, constant(0.05), -1, random);
  EXPECT_EQ(all.center.size(), 1000u);
  expect_clear(all, layout.region);
  const auto some = place_on_lattice(layout, constant(0.05), 150, random);
  EXPECT_EQ(some.center.size(), 150u);
  for (const Vec3d& x : some.center) EXPECT_LT(x.z, 0.2);  // from the bottom up
}

TEST(Lattice, JitterKeepsSpheresApart) {
  RandomNumbers random(1, 0);
  for (const Region& region : {unit_box(), tilted_cylinder()}) {
    LatticeLayout layout{region, 0.11, 1};
    const auto spheres = place_on_lattice(layout, uniform(0.01, 0.05), -1, random);
    EXPECT_GT(spheres.center.size(), 400u);
    expect_clear(spheres, region);
  }
}

TEST(Lattice, SaysHowManyFit) {
  RandomNumbers random(1, 0);
  try {
    place_on_lattice({unit_box(), 0.5, 0}, constant(0.1), 9, random);
    FAIL();
  } catch (const DoesNotFit& fault) {
    EXPECT_STREQ(fault.what(), "the region holds 8 spheres at a spacing of 0.5 m");
  }
}

/// All sites of the box around a region, tried one after the other.
std::vector<Vec3d> sites_by_brute_force(const Region& region, double spacing, double reach) {
  Vec3d low;
  Vec3d high;
  region.bounds(low, high);
  long long cells[3];
  Vec3d first;
  for (int k = 0; k < 3; ++k) {
    cells[k] = static_cast<long long>((high[k] - low[k]) / spacing);
    first[k] = low[k] + spacing / 2;
    if (k < 2) first[k] += (high[k] - low[k] - static_cast<double>(cells[k]) * spacing) / 2;
  }
  std::vector<Vec3d> sites;
  for (long long z = 0; z < cells[2]; ++z)
    for (long long y = 0; y < cells[1]; ++y)
      for (long long x = 0; x < cells[0]; ++x) {
        const Vec3d site = first + spacing * Vec3d{static_cast<double>(x), static_cast<double>(y),
                                                   static_cast<double>(z)};
        if (region.contains(site, reach)) sites.push_back(site);
      }
  return sites;
}

TEST(Lattice, VisitsEverySiteOfACylinderInOrder) {
  for (const Vec3d& axis : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{1, 2, 3},
                            Vec3d{1, -1, 0}, Vec3d{1, 0, 1e-13}, Vec3d{-0.2, 1e-10, 1}})
    for (const double radius : {0.06, 0.3, 0.9}) {
      Region region = tilted_cylinder();
      region.axis = normalized(axis);
      region.center = {0.017, -1.013, 2.007};
      region.radius = radius;
      const auto expected = sites_by_brute_force(region, 0.1013, 0.05);
      RandomNumbers random(1, 0);
      const auto found = place_on_lattice({region, 0.1013, 0}, constant(0.05), -1, random).center;
      ASSERT_EQ(found.size(), expected.size()) << axis.x << " " << axis.y << " " << radius;
      for (std::size_t i = 0; i < found.size(); ++i)
        ASSERT_LT(norm(found[i] - expected[i]), kRounding) << i;
    }
}

/// Time and memory follow the spheres: each of these regions has 10^9 sites or more.
TEST(Layouts, CostNothingForTheWidthOfTheRegion) {
  Region wide;
  wide.lower = {-1e6, -1e6, -1e6};
  wide.upper = {1e6, 1e6, 1e6};
  Region tall = unit_box();
  tall.upper.z = 3e7;
  Region disc = tilted_cylinder();
  disc.axis = {0, 0, 1};
  disc.radius = 1e4;
  Region pole = tilted_cylinder();
  pole.length = 1e7;
  for (const Region& region : {wide, tall, disc, pole}) {
    RandomNumbers random(1, 0);
    const LatticeLayout layout{region, 0.02, 0.5};
    double thickness = 0;
    expect_clear(place_on_lattice(layout, constant(0.008), 20, random), region);
    const auto rain = place_rain_batch(layout, constant(0.008), 20, random, thickness);
    EXPECT_EQ(rain.center.size(), 20u);
    expect_clear(rain, region);
    expect_clear(place_at_random(region, constant(0.008), 20, random), region);
  }
}

TEST(Layouts, RefuseRegionsWithTheNumber) {
  const auto refusal = [](auto place) -> std::string {
    try {
      RandomNumbers random(1, 0);
      place(random);
    } catch (const DoesNotFit& fault) {
      return fault.what();
    }
    return "no error";
  };
  Region far = unit_box();
  far.lower.x = -1e30;
  const std::string message =
      "the region reaches 1e+30 m from the origin, where positions cannot tell spheres of radius "
      "0.05 m apart; must stay within 2.25e+08 m";
  EXPECT_EQ(refusal([&](RandomNumbers& r) { place_at_random(far, constant(0.05), 9, r); }),
            message);
  EXPECT_EQ(refusal([&](RandomNumbers& r) {
              place_on_lattice({far, 0.1, 0}, constant(0.05), 9, r);
            }),
            message);
  double thickness = 0;
  EXPECT_EQ(refusal([&](RandomNumbers& r) {
              place_rain_batch({far, 0.1, 0}, constant(0.05), 9, r, thickness);
            }),
            message);
  far.lower.x = -1e308;
  far.upper.x = 1e308;
  EXPECT_THAT(refusal([&](RandomNumbers& r) { place_at_random(far, constant(0.05), 9, r); }),
              testing::StartsWith("the region reaches 1e+308 m"));
  Region needle = tilted_cylinder();  // no site lies in it but by chance
  needle.radius = 0.0500001;
  needle.length = 1e7;
  EXPECT_THAT(refusal([&](RandomNumbers& r) {
                place_on_lattice({needle, 0.1, 0}, constant(0.05), 100000, r);
              }),
              testing::StartsWith("the region is too large or too thin for a spacing of 0.1 m"));
  EXPECT_THAT(refusal([&](RandomNumbers& r) {
                place_at_random(unit_box(), constant(1e-6), 2'000'000'000'000, r);
              }),
              testing::ContainsRegex("^2000000000000 spheres take .* MiB of host memory"));
}

TEST(RandomLayout, PlacesWithoutOverlap) {
  RandomNumbers random(1, 0);
  for (const Region& region : {unit_box(), tilted_cylinder()}) {
    const auto spheres = place_at_random(region, uniform(0.02, 0.05), 800, random);
    EXPECT_EQ(spheres.center.size(), 800u);
    expect_clear(spheres, region);
  }
}

TEST(RandomLayout, HandlesSizesOneToFifty) {
  RandomNumbers random(1, 0);
  RadiusLaw law;
  law.kind = RadiusLaw::Kind::discrete;
  law.values = {0.2, 0.004};
  law.weights = {1, 999};
  const auto spheres = place_at_random(unit_box(), law, 2000, random);
  expect_clear(spheres, unit_box());
  EXPECT_EQ(spheres.radius[0], 0.2);
  EXPECT_EQ(spheres.radius[1999], 0.004);
}

TEST(RandomLayout, ReachesATightFillAndSaysWhenItIsFull) {
  RandomNumbers random(1, 0);
  EXPECT_EQ(place_at_random(unit_box(), constant(0.05), 480, random).center.size(), 480u);  // 25 %
  try {
    place_at_random(unit_box(), constant(0.05), 2000, random);
    FAIL();
  } catch (const DoesNotFit& fault) {
    EXPECT_THAT(fault.what(), testing::ContainsRegex("^[5-7][0-9][0-9] of 2000 spheres fit"));
  }
}

TEST(RandomLayout, ZeroSpheres) {
  RandomNumbers random(1, 0);
  EXPECT_TRUE(place_at_random(unit_box(), constant(0.1), 0, random).center.empty());
}

TEST(Rain, BatchesTakeTheLowestPlanesAndDoNotOverlap) {
  RandomNumbers random(1, 0);
  LatticeLayout layout{unit_box(), 0.1, 1};
  double thickness = 0;
  const auto one_plane = place_rain_batch(layout, uniform(0.02, 0.04), 60, random, thickness);
  EXPECT_EQ(one_plane.center.size(), 60u);
  EXPECT_DOUBLE_EQ(thickness, 0.1);
  expect_clear(one_plane, layout.region);
  const auto two_planes = place_rain_batch(layout, constant(0.05), 101, random, thickness);
  EXPECT_DOUBLE_EQ(thickness, 0.2);
  expect_clear(two_planes, layout.region);
  EXPECT_THROW(place_rain_batch(layout, constant(0.05), 1001, random, thickness), DoesNotFit);
}

TEST(Layouts, RadiiThatAreAllTheSameAreKeptOnce) {
  RandomNumbers random(1, 0);
  const LatticeLayout layout{unit_box(), 0.1, 0};
  double thickness = 0;
  EXPECT_TRUE(place_on_lattice(layout, constant(0.05), 10, random).radius.uniform());
  EXPECT_TRUE(place_at_random(unit_box(), constant(0.05), 10, random).radius.uniform());
  EXPECT_TRUE(place_rain_batch(layout, constant(0.05), 10, random, thickness).radius.uniform());
  EXPECT_FALSE(place_on_lattice(layout, uniform(0.01, 0.05), 10, random).radius.uniform());
}

TEST(Layouts, AreDeterministic) {
  const auto equal = [](const PlacedSpheres& a, const PlacedSpheres& b) {
    bool same = a.center == b.center;
    for (std::size_t i = 0; same && i < a.center.size(); ++i) same = a.radius[i] == b.radius[i];
    return same;
  };
  const RadiusLaw law = uniform(0.02, 0.04);
  double thickness = 0;
  const auto random_layout = [&](std::uint64_t seed) {
    RandomNumbers random(seed, 0);
    return place_at_random(unit_box(), law, 200, random);
  };
  const auto lattice = [&](std::uint64_t seed) {
    RandomNumbers random(seed, 0);
    return place_on_lattice({unit_box(), 0.1, 0.5}, law, 200, random);
  };
  const auto rain = [&](std::uint64_t seed) {
    RandomNumbers random(seed, 0);
    return place_rain_batch({unit_box(), 0.1, 0.5}, law, 200, random, thickness);
  };
  EXPECT_TRUE(equal(random_layout(1), random_layout(1)));
  EXPECT_FALSE(equal(random_layout(1), random_layout(2)));
  EXPECT_TRUE(equal(lattice(1), lattice(1)));
  EXPECT_FALSE(equal(lattice(1), lattice(2)));
  EXPECT_TRUE(equal(rain(1), rain(1)));
  EXPECT_FALSE(equal(rain(1), rain(2)));
}

}  // namespace
}  // namespace scree
