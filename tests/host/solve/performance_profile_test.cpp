#include "host/solve/performance_profile.h"

#include <gtest/gtest.h>

#include <limits>

namespace scree {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Solver a wins on one problem of four, b on two of which a solves one in three times b's time,
/// and nobody solves the last.
TEST(PerformanceProfile, CountsSharesWithinRatiosOfTheBest) {
  const PerformanceProfile p =
      performance_profile({{"a", "b"}, {{1, 2}, {6, 2}, {never, 5}, {never, never}}});
  EXPECT_EQ(p.ratio, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(p.share[0], (std::vector<double>{0.25, 0.5}));
  EXPECT_EQ(p.share[1], (std::vector<double>{0.25, 0.75}));
  EXPECT_EQ(p.share[2], (std::vector<double>{0.5, 0.75}));
  EXPECT_EQ(to_csv(p), "ratio,a,b\n1,0.25,0.5\n2,0.25,0.75\n3,0.5,0.75\n");
}

TEST(PerformanceProfile, HasOneLineWhereNothingIsSolvedAndForTimesOfZero) {
  EXPECT_EQ(to_csv(performance_profile({{"a"}, {{never}}})), "ratio,a\n1,0\n");
  EXPECT_EQ(to_csv(performance_profile({{"a", "b"}, {{0, 0}}})), "ratio,a,b\n1,1,1\n");
}

}  // namespace
}  // namespace scree
