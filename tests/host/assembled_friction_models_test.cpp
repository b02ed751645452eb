// Solvers whose friction is not the cone: they must solve the law that they name, and say so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/problems/assembled_form.h"
#include "host/problems/matrix_form.h"
#include "solvers/assembled/assembled_solver.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

AssembledProblem random_assembled(unsigned seed) {
  return assembled_form(local_form(fixtures::random_body_problem({.layout = ContactLayout::general,
                                                                  .free_count = 6,
                                                                  .fixed_count = 2,
                                                                  .contact_count = 15,
                                                                  .seed = seed,
                                                                  .mu_max = 0.6})));
}

AssembledResult solve(const char* solver, AssembledModel model, const AssembledProblem& p) {
  AssembledOptions options;
  options.model = model;
  options.tolerance = 1e-11;
  options.max_iterations = 200000;
  return make_assembled_solver(solver)->solve(p, options);
}

/// A contact of mass 1 that slides in a direction, under a normal impulse of 1.
AssembledProblem sliding(double angle) {
  return assemble(1, {{0, 0, {1, 0, 0, 0, 1, 0, 0, 0, 1}}},
                  {-1, 5 * std::cos(angle), 5 * std::sin(angle)}, {0.5});
}

std::vector<double> velocity(const AssembledProblem& p, const std::vector<double>& r) {
  std::vector<double> u;
  multiply(p, r, u);
  for (std::size_t k = 0; k < u.size(); ++k) u[k] += p.q[k];
  return u;
}

TEST(FrictionModels, AreNamedWhereTheyAreNotTheCone) {
  for (const std::string& name : assembled_solver_names()) {
    const bool other = name.rfind("pgs_", 0) == 0;
    EXPECT_EQ(make_assembled_solver(name)->traits().friction != "cone", other) << name;
  }
}

TEST(FrictionModels, BoxHasSqrtTwoTimesTheFrictionAlongTheDiagonal) {
  for (const char* solver : {"pgs_box", "pgs_box_lagged"}) {
    SCOPED_TRACE(solver);
    const AssembledProblem p = sliding(std::numbers::pi / 4);
    const AssembledResult result = solve(solver, AssembledModel::exact, p);
    EXPECT_EQ(result.status, AssembledStatus::stalled);
    EXPECT_NE(result.note.find("box"), std::string::npos) << result.note;
    EXPECT_NEAR(result.r[0], 1, 1e-10);
    EXPECT_NEAR(result.r[1], -0.5, 1e-10);
    EXPECT_NEAR(result.r[2], -0.5, 1e-10);
  }
}

TEST(FrictionModels, BoxOfBothBoundsIsSolvedRowByRow) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const AssembledProblem p = random_assembled(seed);
    const AssembledResult result = solve("pgs_box", AssembledModel::exact, p);
    if (result.note.find("box") == std::string::npos) continue;  // bounds that never settle
    const std::vector<double> u = velocity(p, result.r);
    for (int c = 0; c < p.contact_count; ++c) {
      const double* r = &result.r[3 * c];
      EXPECT_NEAR(r[0] - std::max(0.0, r[0] - u[3 * c]), 0, 1e-7);
      for (int k = 1; k < 3; ++k) {
        const double bound = p.mu[c] * r[0];
        EXPECT_NEAR(r[k] - std::clamp(r[k] - u[3 * c + k], -bound, bound), 0, 1e-7);
      }
    }
  }
}

TEST(FrictionModels, BoxesHaveNoConvexModel) {
  const AssembledResult result = solve("pgs_box", AssembledModel::convex, sliding(0));
  EXPECT_EQ(result.status, AssembledStatus::unsupported);
}

TEST(FrictionModels, PyramidsHaveLessFrictionBetweenTheirEdges) {
  const double eighth = std::numbers::pi / 8;
  for (const auto& [solver, angle, most] :
       {std::tuple{"pgs_pyramid4", 0.0, 0.5}, std::tuple{"pgs_pyramid8", 2 * eighth, 0.5},
        std::tuple{"pgs_pyramid8", eighth, 0.5 * std::cos(eighth)}}) {
    SCOPED_TRACE(solver);
    const AssembledProblem p = sliding(angle);
    const AssembledResult result = solve(solver, AssembledModel::exact, p);
    EXPECT_NEAR(result.r[0], 1, 1e-9);
    // Friction that acts against the motion.
    EXPECT_NEAR(-(result.r[1] * std::cos(angle) + result.r[2] * std::sin(angle)), most, 1e-9);
  }
}

/// At the minimum over a pyramid no edge leads down, and edges in use lead nowhere.
TEST(FrictionModels, PyramidsReachTheMinimumOfTheConvexModel) {
  for (const auto& [solver, sides] : {std::pair{"pgs_pyramid4", 4}, std::pair{"pgs_pyramid8", 8}}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      SCOPED_TRACE(std::string(solver) + " " + std::to_string(seed));
      const AssembledProblem p = random_assembled(seed);
      const AssembledResult result = solve(solver, AssembledModel::convex, p);
      EXPECT_NE(result.note.find("pyramid"), std::string::npos);
      const std::vector<double> u = velocity(p, result.r);
      double work = 0, load = 0;
      for (int c = 0; c < p.contact_count; ++c) {
        for (int j = 0; j < sides; ++j) {
          const double angle = 2 * std::numbers::pi * j / sides;
          const double slope = u[3 * c] + p.mu[c] * (std::cos(angle) * u[3 * c + 1] +
                                                     std::sin(angle) * u[3 * c + 2]);
          EXPECT_GE(slope, -1e-7);
        }
        for (int k = 0; k < 3; ++k) {
          work += result.r[3 * c + k] * u[3 * c + k];
          load += std::abs(result.r[3 * c + k] * p.q[3 * c + k]);
        }
      }
      EXPECT_NEAR(work, 0, 1e-7 * load);
    }
  }
}

TEST(FrictionModels, MoreSidesComeCloserToTheCone) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const AssembledProblem p = random_assembled(seed);
    const auto minimum = [&](const char* solver) {
      return solve(solver, AssembledModel::convex, p).residual.objective;
    };
    const double cone = minimum("interior_point"), eight = minimum("pgs_pyramid8"),
                 four = minimum("pgs_pyramid4");
    const double rounding = 1e-9 * std::abs(cone);
    EXPECT_LE(cone, eight + rounding);
    EXPECT_LE(eight, four + rounding);
  }
}

}  // namespace
}  // namespace scree
