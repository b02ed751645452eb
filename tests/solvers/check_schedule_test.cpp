// When a solver checks its residual.
#include "solvers/check_schedule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scree {
namespace {

TEST(CheckSchedule, FindsTheEndOfAPowerLaw) {
  const auto residual = [](int k) { return 100 * std::pow(k + 5.0, -1.5); };
  CheckSchedule schedule(10, residual(37));
  int k = 0;
  for (const int expected : {10, 20, 30, 37}) {
    k += schedule.next(k, residual(k));
    EXPECT_EQ(k, expected);
  }
}

TEST(CheckSchedule, LooksNeitherTooOftenNorTooSeldom) {
  CheckSchedule schedule(10, 1);
  EXPECT_EQ(schedule.next(0, 1000), 10);
  EXPECT_EQ(schedule.next(10, 1.01), 3);  // almost there
  EXPECT_EQ(schedule.next(13, 1.5), 10);  // it rose
  EXPECT_EQ(schedule.next(23, 1.5), 10);  // it stood still
  EXPECT_EQ(schedule.next(23, 1.2), 10);  // no iteration between
  EXPECT_EQ(schedule.next(33, std::numeric_limits<double>::infinity()), 10);
  CheckSchedule often(2, 1);
  EXPECT_EQ(often.next(0, 2), 2);
  EXPECT_EQ(often.next(2, 1.01), 2);
}

TEST(CheckSchedule, WaitsLongerWhereItMay) {
  CheckSchedule schedule(10, 1);
  EXPECT_EQ(schedule.next(0, 1000), 10);
  schedule.set_longest(40);
  EXPECT_EQ(schedule.next(20, 100), 40);
  schedule.set_longest(10);
  EXPECT_EQ(schedule.next(40, 50), 10);
}

TEST(CheckSchedule, WithoutAToleranceTheLongestBlocksAreRun) {
  CheckSchedule schedule(20, 0);
  EXPECT_EQ(schedule.next(0, 1), 20);
  EXPECT_EQ(schedule.next(20, 0.1), 20);
  EXPECT_EQ(schedule.next(40, 0), 20);
}

}  // namespace
}  // namespace scree
