// What ranks agree on before they start.

#include "host/ranks/agreement.h"

#include <gtest/gtest.h>

#include <vector>

#include "host/ranks/thread_ranks.h"

namespace scree {
namespace {

RankReport ready() {
  return {0, "", "0.1.0 (abc)", "{\"name\": \"a\"}", "backend cpu in float", "/out"};
}

/// All ranks agree on one thing, which is given back. @param reports  of each rank
Agreement agreed(const std::vector<RankReport>& reports) {
  std::vector<Agreement> all(reports.size());
  run_thread_ranks(static_cast<int>(reports.size()), [&](const std::shared_ptr<Ranks>& ranks) {
    const auto r = static_cast<std::size_t>(ranks->rank());
    all[r] = agree(*ranks, reports[r]);
  });
  for (const Agreement& each : all) {
    EXPECT_EQ(each.code, all.front().code);
    EXPECT_EQ(each.message, all.front().message);
  }
  return all.front();
}

TEST(RankAgreement, RanksThatAreAlikeStart) {
  for (const std::size_t count : {1u, 2u, 5u}) {
    const Agreement start = agreed(std::vector<RankReport>(count, ready()));
    EXPECT_EQ(start.code, 0);
    EXPECT_EQ(start.message, "");
  }
}

TEST(RankAgreement, AnErrorOfAllIsToldWithoutARank) {
  RankReport missing = ready();
  missing.code = 2;
  missing.error = "a.json: no such file";
  missing.scene = missing.arithmetic = "";
  const Agreement end = agreed(std::vector<RankReport>(3, missing));
  EXPECT_EQ(end.code, 2);
  EXPECT_EQ(end.message, "a.json: no such file");
}

TEST(RankAgreement, AnErrorOfOneNamesItAndEndsAllWithItsCode) {
  for (const std::size_t failing : {0u, 2u}) {
    std::vector<RankReport> reports(4, ready());
    reports[failing] = {1, "host memory exhausted", ready().program, "", "", ""};
    const Agreement end = agreed(reports);
    EXPECT_EQ(end.code, 1);
    EXPECT_EQ(end.message, "rank " + std::to_string(failing) + ": host memory exhausted");
  }
}

TEST(RankAgreement, OfDifferentErrorsTheFirstIsTold) {
  std::vector<RankReport> reports(3, ready());
  reports[1].code = reports[2].code = 2;
  reports[1].error = "b.obj: no such file";
  reports[2].error = "c.obj: no such file";
  EXPECT_EQ(agreed(reports).message, "rank 1: b.obj: no such file");
  reports[0].code = 2;  // all have failed, but not alike
  reports[0].error = "a.obj: no such file";
  EXPECT_EQ(agreed(reports).message, "rank 0: a.obj: no such file");
}

TEST(RankAgreement, WhatDiffersIsNamedWithItsRank) {
  std::vector<RankReport> reports(4, ready());
  reports[1].folder = "/tmp";
  EXPECT_EQ(agreed(reports).message, "rank 1 would write to /tmp, rank 0 to /out");
  reports[3].arithmetic = "backend cuda in float";
  EXPECT_EQ(agreed(reports).message,
            "rank 3 would compute with backend cuda in float, rank 0 with backend cpu in float");
  reports[2].scene = "{\"name\": \"b\"}";
  EXPECT_EQ(agreed(reports).message, "rank 2 has another scene than rank 0");
  reports[1].program = "0.1.0 (def)";
  const Agreement end = agreed(reports);
  EXPECT_EQ(end.message,
            "rank 1 has another version of scree: 0.1.0 (def), rank 0 has 0.1.0 (abc)");
  EXPECT_EQ(end.code, 2);
}

}  // namespace
}  // namespace scree
