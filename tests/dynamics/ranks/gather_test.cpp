// What ranks bring together, on threads.

#include "dynamics/ranks/gather.h"

#include <gtest/gtest.h>

#include "dynamics/ranks/common_error.h"
#include "host/ranks/thread_ranks.h"

namespace scree {
namespace {

TEST(RanksTogether, SumForcesAndNameTheWorstContact) {
  run_thread_ranks(3, [](const std::shared_ptr<Ranks>& ranks) {
    const int k = ranks->rank();
    const ForceRecord sum = added_over_ranks(*ranks, {{1.0 * k, 0, 0}, {0, 2.0 * k, 0}});
    EXPECT_EQ(sum.force.x, 3);
    EXPECT_EQ(sum.torque.y, 6);
    StepReport report;
    report.body_count = 10 * (k + 1);
    report.residual_max_body_a = k == 2 ? -1 : k;  // rank 2 has no contact
    report.residual_max_body_b = k + 100;
    EXPECT_TRUE(add_report(*ranks, k, k == 1 ? 0.5 : 0.25, true, report));
    EXPECT_EQ(report.body_count, 60);
    EXPECT_EQ(report.residual_max, 0.5);
    EXPECT_EQ(report.residual_max_body_a, 1);
    EXPECT_EQ(report.residual_max_body_b, 101);
    EXPECT_DOUBLE_EQ(report.largest_share, 1.5);
    EXPECT_DOUBLE_EQ(report.ghost_share, 3.0 / 60);
    EXPECT_FALSE(add_report(*ranks, 0, 0, k != 1, report));
  });
}

TEST(RanksTogether, ThrowTheErrorOfTheLowestThatHasOne) {
  run_thread_ranks(3, [](const std::shared_ptr<Ranks>& ranks) {
    const bool fails = ranks->rank() > 0;
    try {
      throw_on_all(ranks.get(), fails,
                   [&] { throw RunError("rank " + std::to_string(ranks->rank())); });
      ADD_FAILURE() << "no error";
    } catch (const CommonError& error) {
      EXPECT_STREQ(error.what(), "rank 1");
    }
  });
}

}  // namespace
}  // namespace scree
