// The cut of space among ranks.

#include "dynamics/ranks/decomposition.h"

#include <gtest/gtest.h>

#include <random>

namespace scree {
namespace {

std::vector<WorkSample> cloud(std::size_t count, double length, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<WorkSample> samples;
  for (std::size_t i = 0; i < count; ++i)
    samples.push_back({{length * uniform(random), uniform(random), 0.2 * uniform(random)}});
  return samples;
}

TEST(Decomposition, GivesEachRankItsShareOfTheWork) {
  for (const int ranks : {1, 2, 3, 5, 8, 16}) {
    std::vector<WorkSample> samples = cloud(20000, 3, 1);
    for (WorkSample& sample : samples) sample.weight = sample.position.x;  // more work on one side
    const Decomposition cut = Decomposition::of(samples, ranks);
    std::vector<double> work(static_cast<std::size_t>(ranks));
    double total = 0;
    for (const WorkSample& sample : samples) {
      const int owner = cut.owner(sample.position);
      ASSERT_TRUE(owner >= 0 && owner < ranks);
      work[static_cast<std::size_t>(owner)] += sample.weight;
      total += sample.weight;
    }
    for (const double share : work)
      EXPECT_NEAR(share, total / ranks, 0.01 * total / ranks) << ranks;
  }
}

TEST(Decomposition, CutsAcrossTheLongestSide) {
  const Decomposition cut = Decomposition::of(cloud(1000, 3, 2), 2);
  ASSERT_EQ(cut.cuts().size(), 1u);
  EXPECT_EQ(cut.cuts()[0].axis, 0);
  EXPECT_NEAR(cut.cuts()[0].position, 1.5, 0.15);
}

TEST(Decomposition, ServesFewerSamplesThanRanksAndNone) {
  for (const std::size_t count : {0u, 1u, 3u}) {
    const Decomposition cut = Decomposition::of(cloud(count, 1, 3), 7);
    for (const WorkSample& sample : cloud(100, 2, 4)) {
      const int owner = cut.owner(sample.position);
      EXPECT_TRUE(owner >= 0 && owner < 7);
    }
  }
}

TEST(Decomposition, PlacesThatAreTheSameHaveOneOwner) {
  const std::vector<WorkSample> samples(50, WorkSample{{1, 2, 3}});
  const Decomposition cut = Decomposition::of(samples, 4);
  const int owner = cut.owner({1, 2, 3});
  EXPECT_TRUE(owner >= 0 && owner < 4);
}

}  // namespace
}  // namespace scree
