// What a solver predicts of its residual.
#include "solvers/residual_gauge.h"

#include <gtest/gtest.h>

namespace scree {
namespace {

TEST(ResidualGauge, KnowsNothingBeforeTheFirstCheck) {
  ResidualGauge gauge;
  EXPECT_FALSE(gauge.is_known());
  EXPECT_LT(gauge.level(1e-3), 0);
  gauge.note(0, 1e-3);  // of the guess, before any iteration
  EXPECT_FALSE(gauge.is_known());
  EXPECT_LT(gauge.level(1e-3), 0);
}

TEST(ResidualGauge, TheLevelStaysBelowAllThatFailed) {
  ResidualGauge gauge;
  gauge.note(1e-5, 1e-3);
  gauge.note(2e-5, 1.5e-3);  // the measure is too large for once
  EXPECT_LT(gauge.level(1e-4), 1e-6);
  EXPECT_GT(gauge.level(1e-4), 0.95e-6);
  const double level = gauge.level(1e-4);
  gauge.note(0.99 * level, 1.02e-4);  // there, but the residual is not
  EXPECT_LT(gauge.level(1e-4), 0.99 * level);
  EXPECT_LT(gauge.level(0), 0);  // which is never reached
}

TEST(ResidualGauge, CarriesWhatItLearnedToTheNextSolve) {
  ResidualGauge gauge;
  gauge.note(1e-5, 1e-3);
  const double level = gauge.level(1e-4);
  gauge.start_solve();
  EXPECT_EQ(gauge.level(1e-4), level);
  gauge.note(1e-5, 0.5e-3);  // one check is not enough to forget it all
  EXPECT_GT(gauge.level(1e-4), level);
  EXPECT_LT(gauge.level(1e-4), 1.2 * level);
  gauge.start_solve();  // nor is a solve: its only check may have met a measure that was too large
  EXPECT_LT(gauge.level(1e-4), 1.2 * level);
  for (int k = 0; k < 10; ++k) {
    gauge.note(1e-5, 0.5e-3);
    gauge.start_solve();
  }
  EXPECT_NEAR(gauge.level(1e-4), 2 * level, 1e-12);

  ResidualGauge resumed;
  resumed.carry(gauge.carried());
  EXPECT_EQ(resumed.level(1e-4), gauge.level(1e-4));
  resumed.note(1e-5, 0.45e-3);
  gauge.note(1e-5, 0.45e-3);
  EXPECT_EQ(resumed.level(1e-4), gauge.level(1e-4));
}

}  // namespace
}  // namespace scree
