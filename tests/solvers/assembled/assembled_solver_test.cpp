// Every solver of assembled problems on the same problems: against closed forms, the dense oracle
// and each other; and how they end where there is no solution or no way to one.
#include "solvers/assembled/assembled_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/problems/matrix_form.h"
#include "solvers/assembled/infeasibility.h"
#include "tests/assembled_samples.h"

namespace scree {
namespace {

using fixtures::one_contact;
using fixtures::random_local_problem;
using fixtures::velocity;
using testing::HasSubstr;

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum);
}
double norm_of(const std::vector<double>& a) { return distance(a, std::vector<double>(a.size())); }

AssembledOptions to(double tolerance, AssembledModel model) {
  AssembledOptions o;
  o.model = model;
  o.tolerance = tolerance;
  o.max_seconds = 30;
  return o;
}

class AssembledSolvers : public ::testing::TestWithParam<std::string> {
 protected:
  AssembledResult solve(const AssembledProblem& p, const AssembledOptions& o) const {
    return make_assembled_solver(GetParam())->solve(p, o);
  }
  /// Plain Newton breaks down where contacts are redundant, and may where they are not.
  bool is_robust() const { return GetParam() != "newton" && GetParam() != "newton_krylov"; }
};

/// Those whose law is that of the residual; assembled_friction_models_test.cpp has the others.
std::vector<std::string> cone_solvers() {
  std::vector<std::string> names = assembled_solver_names();
  std::erase_if(names, [](const std::string& name) {
    return make_assembled_solver(name)->traits().friction != "cone";
  });
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, AssembledSolvers, ::testing::ValuesIn(cone_solvers()),
                         [](const auto& info) { return info.param; });

TEST_P(AssembledSolvers, NamesAndDescribesItself) {
  const AssembledTraits traits = make_assembled_solver(GetParam())->traits();
  EXPECT_EQ(traits.name, GetParam());
  EXPECT_FALSE(traits.description.empty());
  EXPECT_TRUE(traits.exact || traits.convex);
}

TEST_P(AssembledSolvers, OneSlidingContactHasItsClosedForm) {
  const double g_h = 0.024525, v0 = 2, mu = 0.3;
  const AssembledProblem p = one_contact({1, 0, 0, 0, 1, 0, 0, 0, 1}, {-g_h, v0, 0}, mu);
  const AssembledResult exact = solve(p, to(1e-10, AssembledModel::exact));
  ASSERT_EQ(exact.status, AssembledStatus::converged) << exact.note;
  EXPECT_NEAR(exact.r[0], g_h, 1e-8);
  EXPECT_NEAR(exact.r[1], -mu * g_h, 1e-8);
  const AssembledResult convex = solve(p, to(1e-10, AssembledModel::convex));
  ASSERT_EQ(convex.status, AssembledStatus::converged) << convex.note;
  EXPECT_NEAR(convex.r[0], 0.548434 + g_h, 1e-6);
}

/// Four supports of one box: how they share its weight is not determined, but from zero
/// they share it equally.
TEST_P(AssembledSolvers, ABoxOnFourCornersIsCarried) {
  if (!is_robust()) GTEST_SKIP() << "plain Newton has no inverse here";
  const double m = 3, speed = 0.01;
  const AssembledProblem p = fixtures::box_on_four_corners(m, 0.2, 0.1, speed);
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    const AssembledResult result = solve(p, to(1e-12, model));
    ASSERT_EQ(result.status, AssembledStatus::converged) << result.note;
    double sum = 0;
    for (int c = 0; c < 4; ++c) sum += result.r[3 * c];
    EXPECT_NEAR(sum, m * speed, 1e-10 * m * speed + 2e-12);
  }
}

/// Random problems with bodies, W mostly singular, against the interior-point oracle.
TEST_P(AssembledSolvers, ConvexProblemsHaveTheOraclesMinimum) {
  if (!is_robust()) GTEST_SKIP() << "plain Newton is not expected to solve these";
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const BodyProblem bodies =
        fixtures::random_body_problem({.layout = ContactLayout::general,
                                       .contact_count = 8 + 3 * static_cast<int>(seed),
                                       .seed = seed});
    const AssembledProblem p = assembled_form(local_form(bodies));
    const oracle::Solution expected = oracle::solve_convex(fixtures::oracle_of(bodies));
    const AssembledResult result = solve(p, to(1e-10, AssembledModel::convex));
    EXPECT_EQ(result.status, AssembledStatus::converged)
        << "seed " << seed << " " << result.note << " " << result.residual.relative;
    EXPECT_NEAR(result.residual.objective, expected.objective, 1e-9 * std::abs(expected.objective))
        << "seed " << seed;
  }
}

TEST_P(AssembledSolvers, CoulombProblemsAreSolvedAsTheOracleJudges) {
  if (!is_robust()) GTEST_SKIP() << "plain Newton is not expected to solve these";
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const BodyProblem bodies = fixtures::random_body_problem({.layout = ContactLayout::general,
                                                              .free_count = 8,
                                                              .contact_count = 14,
                                                              .seed = seed,
                                                              .mu_max = 0.6});
    const AssembledProblem p = assembled_form(local_form(bodies));
    const AssembledResult result = solve(p, to(1e-9, AssembledModel::exact));
    EXPECT_EQ(result.status, AssembledStatus::converged)
        << "seed " << seed << " " << result.note << " " << result.residual.relative;
    const oracle::Problem o = fixtures::oracle_of(bodies);
    std::vector<Eigen::Vector3d> world;
    for (const Vec3d& v : to_world(bodies, result.r)) world.push_back(fixtures::to_eigen(v));
    EXPECT_LE(oracle::residual(o, oracle::rows_from_world(o, world)).exact_rms,
              1e-7 * norm_of(p.q));
  }
}

/// In two dimensions the second tangent must stay out of it.
TEST_P(AssembledSolvers, TwoDimensionalProblemsAreSolvedInTheirPlane) {
  if (!is_robust()) GTEST_SKIP() << "plain Newton is not expected to solve these";
  for (const bool redundant : {false, true}) {
    const LocalProblem local = random_local_problem(2, 6, redundant, 3);
    const AssembledProblem p = assembled_form(local);
    EXPECT_EQ(p.dimension, 2);
    for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
      const AssembledResult result = solve(p, to(1e-9, model));
      ASSERT_EQ(result.status, AssembledStatus::converged) << result.note;
      const std::vector<double> r = from_three_rows(2, result.r);
      std::vector<double> u = multiply(local.W, r);
      for (int c = 0; c < 6; ++c) {
        EXPECT_NEAR(result.r[3 * c + 2], 0, 0);
        const double mu = local.mu[c], u_t = u[2 * c + 1] + local.q[2 * c + 1];
        const double v_n =
            u[2 * c] + local.q[2 * c] + (model == AssembledModel::exact ? mu * std::abs(u_t) : 0);
        const double bound = 1e-7 * norm_of(local.q);
        EXPECT_LE(std::abs(r[2 * c + 1]), mu * r[2 * c] + 1e-9);
        EXPECT_GE(v_n, mu * std::abs(u_t) - bound);
        EXPECT_NEAR(r[2 * c] * v_n + r[2 * c + 1] * u_t, 0, bound * (1 + norm_of(r)));
      }
    }
  }
}

TEST_P(AssembledSolvers, AnUnsymmetricOperatorIsUsedAsItIsOrSymmetrizedWithANote) {
  AssembledProblem p = assembled_form(random_local_problem(3, 5, false, 4));
  for (int c = 0; c < 5; ++c) p.diagonal(c)[5] += 1e-2 * p.diagonal(c)[4];
  const AssembledResult exact = solve(p, to(1e-9, AssembledModel::exact));
  EXPECT_TRUE(exact.status == AssembledStatus::converged || !is_robust()) << exact.note;
  EXPECT_EQ(measure(p, AssembledModel::exact, exact.r).relative, exact.residual.relative);
  const AssembledResult convex = solve(p, to(1e-9, AssembledModel::convex));
  EXPECT_THAT(convex.note, HasSubstr("symmetrized"));
  EXPECT_TRUE(convex.status == AssembledStatus::converged || !is_robust()) << convex.note;
  EXPECT_EQ(measure(symmetrized(p), AssembledModel::convex, convex.r).relative,
            convex.residual.relative);
}

TEST_P(AssembledSolvers, AGuessThatSolvesTheProblemIsKept) {
  const AssembledProblem p = assembled_form(random_local_problem(3, 5, false, 6));
  AssembledOptions o = to(1e-11, AssembledModel::exact);
  const AssembledResult first = make_assembled_solver("auto")->solve(p, o);
  ASSERT_EQ(first.status, AssembledStatus::converged);
  o.guess = first.r;
  o.tolerance = 1e-9;
  const AssembledResult again = solve(p, o);
  EXPECT_EQ(again.status, AssembledStatus::converged);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(again.r, first.r);
}

TEST_P(AssembledSolvers, StopsAtTheLimitWithItsBestAndAnAccount) {
  const AssembledProblem p = assembled_form(random_local_problem(3, 12, true, 7));
  AssembledOptions o = to(1e-30, AssembledModel::exact);
  o.max_iterations = 3;
  o.check_every = 1;
  std::vector<AssembledCurvePoint> curve;
  const AssembledResult result = make_assembled_solver(GetParam())->solve(p, o, &curve);
  EXPECT_NE(result.status, AssembledStatus::converged);
  EXPECT_LE(result.iterations, 3);
  EXPECT_GT(result.applications, 0);
  ASSERT_FALSE(curve.empty());
  double best = curve.front().residual.relative;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    best = std::min(best, curve[k].residual.relative);
    if (k > 0) {
      EXPECT_GE(curve[k].iteration, curve[k - 1].iteration);
      EXPECT_GE(curve[k].applications, curve[k - 1].applications);
    }
  }
  EXPECT_EQ(result.residual.relative, best);
  EXPECT_EQ(measure(p, AssembledModel::exact, result.r).relative, best);
}

/// Two walls that close in on one body: impulses grow and no velocity is right.
AssembledProblem closing_walls(double mu) {
  return assemble(2,
                  {{0, 0, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                   {1, 1, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                   {0, 1, {-1, 0, 0, 0, 1, 0, 0, 0, 1}},
                   {1, 0, {-1, 0, 0, 0, 1, 0, 0, 0, 1}}},
                  {-1, 0, 0, -1, 0, 0}, {mu, mu});
}

TEST_P(AssembledSolvers, AProblemWithoutSolutionEndsWithAStatus) {
  AssembledOptions o = to(1e-9, AssembledModel::convex);
  o.max_seconds = 5;
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    o.model = model;
    for (const double mu : {0.0, 0.3}) {
      const AssembledResult result = solve(closing_walls(mu), o);
      EXPECT_EQ(result.status, AssembledStatus::no_solution) << mu << " " << result.note;
      for (const double x : result.r) EXPECT_TRUE(std::isfinite(x));
      EXPECT_LT(result.seconds, 1);  // it shows after a few thousand iterations
    }
  }
}

TEST(AssembledSolver, WallsThatCloseInAreToldApartFromSlowProgress) {
  const AssembledResult convex =
      make_assembled_solver("nlgs")->solve(closing_walls(0.3), to(1e-9, AssembledModel::convex));
  EXPECT_EQ(convex.status, AssembledStatus::no_solution);
  EXPECT_THAT(convex.note, HasSubstr("without bound"));
  const AssembledResult exact =
      make_assembled_solver("auto")->solve(closing_walls(0.3), to(1e-9, AssembledModel::exact));
  EXPECT_EQ(exact.status, AssembledStatus::no_solution);
  EXPECT_THAT(exact.note, HasSubstr("approach"));
  EXPECT_LT(exact.iterations, 100);
}

/// Walls that close in at an angle: the body is free to slide out, so that the exact model has
/// velocities, and nothing is claimed of it; the convex model has none in its dual cones.
TEST(AssembledSolver, AWedgeIsWithoutSolutionOfTheConvexModelOnly) {
  const double a = 0.1;
  const std::array<std::array<double, 3>, 6> rows = {{{std::cos(a), std::sin(a), 0},
                                                      {-std::sin(a), std::cos(a), 0},
                                                      {0, 0, 1},
                                                      {-std::cos(a), std::sin(a), 0},
                                                      {-std::sin(a), -std::cos(a), 0},
                                                      {0, 0, 1}}};
  std::vector<PlacedBlock> blocks;
  for (int c = 0; c < 2; ++c)
    for (int d = 0; d < 2; ++d) {
      PlacedBlock block{c, d, {}};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k)
            block.value[3 * i + j] += rows[3 * c + i][k] * rows[3 * d + j][k];
      blocks.push_back(block);
    }
  const std::vector<double> q = {-1, 0, 0, -1, 0, 0};
  for (const double mu : {0.0, 0.5}) {
    const AssembledProblem p = assemble(2, blocks, q, {mu, mu});
    EXPECT_EQ(has_no_solution(p, AssembledModel::convex, 0), mu > 0);
    EXPECT_FALSE(has_no_solution(p, AssembledModel::exact, 0));
  }
}

/// Gyroscopic terms can do what the symmetric part of W cannot: here a tangential impulse
/// moves the walls apart.
TEST(AssembledSolver, AnUnsymmetricOperatorIsAskedAsItIs) {
  AssembledProblem p = closing_walls(0.3);
  EXPECT_TRUE(has_no_solution(p, AssembledModel::exact, 0));
  for (int c = 0; c < 2; ++c)
    for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k) {
      if (c == 0 && p.column[k] == 1) p.block[k][1] = 0.2;
      if (c == 1 && p.column[k] == 0) p.block[k][3] = -0.2;
    }
  EXPECT_FALSE(has_no_solution(p, AssembledModel::exact, 0));
}

/// Impulses at its foot are large against those of single contacts, as without solution, but end.
TEST(AssembledSolver, AHighTowerIsNotTakenForAProblemWithoutSolution) {
  constexpr int levels = 400;
  std::vector<PlacedBlock> blocks;
  std::vector<double> q(3 * levels, 0.0);
  q[0] = -1;  // all fall together, on the ground alone
  for (int c = 0; c < levels; ++c) {
    const double own = c == 0 ? 1 : 2;
    blocks.push_back({c, c, {own, 0, 0, 0, own, 0, 0, 0, own}});
    if (c == 0) continue;
    blocks.push_back({c, c - 1, {-1, 0, 0, 0, -1, 0, 0, 0, -1}});
    blocks.push_back({c - 1, c, {-1, 0, 0, 0, -1, 0, 0, 0, -1}});
  }
  const AssembledProblem p = assemble(levels, blocks, q, std::vector<double>(levels, 0.5));
  for (const char* solver : {"apgd", "spg", "interior_point"}) {
    const AssembledResult result =
        make_assembled_solver(solver)->solve(p, to(1e-6, AssembledModel::convex));
    EXPECT_EQ(result.status, AssembledStatus::converged) << solver << " " << result.note;
    EXPECT_NEAR(result.r[0], levels, 1);
  }
}

TEST(AssembledSolver, AContactThatNothingActsOnIsNamed) {
  const AssembledProblem p =
      assemble(2, {{0, 0, {1, 0, 0, 0, 1, 0, 0, 0, 1}}}, {-1, 0, 0, -1, 0, 0}, {0.3, 0.3});
  const AssembledResult result =
      make_assembled_solver("auto")->solve(p, to(1e-9, AssembledModel::exact));
  EXPECT_EQ(result.status, AssembledStatus::no_solution);
  EXPECT_THAT(result.note, HasSubstr("contact 1"));
}

/// The same contact twice: elimination meets an exact zero.
TEST(AssembledSolver, NewtonGetsPastAContactThatIsThereTwice) {
  const Block3 unit{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const AssembledProblem p = assemble(2, {{0, 0, unit}, {0, 1, unit}, {1, 0, unit}, {1, 1, unit}},
                                      {-1, 0, 0, -1, 0, 0}, {0.5, 0.5});
  const AssembledOptions o = to(1e-10, AssembledModel::exact);
  for (const char* solver : {"newton", "hybrid", "proximal"}) {
    const AssembledResult result = make_assembled_solver(solver)->solve(p, o);
    EXPECT_EQ(result.status, AssembledStatus::converged) << solver << ": " << result.note;
    EXPECT_NEAR(result.r[0] + result.r[3], 1, 1e-9) << solver;
  }
}

/// W has rank 6 of 12 and all contacts stick, from zero and from any other start.
TEST(AssembledSolver, NewtonCarriesABoxOnFourCorners) {
  const AssembledProblem p = fixtures::box_on_four_corners(3, 0.2, 0.1, 0.01);
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    const AssembledResult result = make_assembled_solver("newton")->solve(p, to(1e-10, model));
    ASSERT_EQ(result.status, AssembledStatus::converged) << result.note;
    double sum = 0;
    for (int c = 0; c < 4; ++c) sum += result.r[3 * c];
    EXPECT_NEAR(sum, 0.03, 1e-10);
  }
}

TEST(AssembledSolver, NewtonIsQuadraticWhereTheOperatorIsRegular) {
  const AssembledProblem p = assembled_form(random_local_problem(3, 10, false, 9));
  AssembledOptions o = to(1e-13, AssembledModel::exact);
  const AssembledResult near = make_assembled_solver("nlgs")->solve(p, to(1e-3, o.model));
  o.guess = near.r;
  const AssembledResult result = make_assembled_solver("newton")->solve(p, o);
  EXPECT_EQ(result.status, AssembledStatus::converged) << result.note;
  EXPECT_LE(result.iterations, 8);
}

TEST(AssembledSolver, ToleranceZeroRunsAllIterations) {
  const AssembledProblem p = one_contact({1, 0, 0, 0, 1, 0, 0, 0, 1}, {-1, 2, 0}, 0.3);
  AssembledOptions o = to(0, AssembledModel::exact);
  o.max_iterations = 25;
  const AssembledResult result = make_assembled_solver("nlgs")->solve(p, o);
  EXPECT_EQ(result.iterations, 25);
  EXPECT_EQ(result.status, AssembledStatus::iteration_limit);
}

TEST(AssembledSolver, CurvesHoldTheErrorAgainstAReference) {
  const AssembledProblem p = assembled_form(random_local_problem(3, 8, false, 12));
  AssembledOptions o = to(1e-12, AssembledModel::exact);
  o.reference_velocity = velocity(p, make_assembled_solver("auto")->solve(p, o).r);
  std::vector<AssembledCurvePoint> curve;
  o.check_every = 1;
  make_assembled_solver("nlgs")->solve(p, o, &curve);
  ASSERT_GT(curve.size(), 2u);
  EXPECT_GT(curve.front().velocity_error, 1e-3);
  EXPECT_LE(curve.back().velocity_error, 1e-8);
  EXPECT_GT(curve[1].state_changes, 0);
  EXPECT_EQ(curve.back().state_changes, 0);
}

TEST(AssembledSolver, KineticErrorIsTheEnergyOfTheDifference) {
  // Two masses of 2 kg against the ground: W = 1/2, no friction. Contact 0 has to stop at 3 m/s.
  const AssembledProblem p = assemble(
      2, {{0, 0, {0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5}}, {1, 1, {0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5}}},
      {-3, 0, 0, 1, 0, 0}, {0, 0});
  AssembledOptions o = to(1e-12, AssembledModel::convex);
  o.reference_impulse = {6, 0, 0, 0, 0, 0};
  o.reference_velocity = contact_velocity(p, o.reference_impulse);
  o.check_every = 1;
  std::vector<AssembledCurvePoint> curve;
  make_assembled_solver("gauss_seidel")->solve(p, o, &curve);
  ASSERT_EQ(curve.size(), 2u);
  EXPECT_DOUBLE_EQ(curve.front().kinetic_error, 0.5 * 2 * 3 * 3);
  EXPECT_EQ(curve.back().kinetic_error, 0);
  o.reference_impulse.clear();
  curve.clear();
  make_assembled_solver("gauss_seidel")->solve(p, o, &curve);
  EXPECT_EQ(curve.front().kinetic_error, -1);
  EXPECT_NEAR(curve.front().velocity_error, 3, 1e-12);
}

TEST(AssembledSolver, MistakesOfTheCallerAreNamed) {
  const AssembledProblem p = one_contact({1, 0, 0, 0, 1, 0, 0, 0, 1}, {-1, 2, 0}, 0.3);
  const auto fault = [&](const AssembledProblem& problem, const AssembledOptions& o) {
    try {
      make_assembled_solver("nlgs")->solve(problem, o);
    } catch (const AssembledError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  AssembledOptions o;
  o.guess = {1, 2};
  EXPECT_THAT(fault(p, o), HasSubstr("guess has 2 values, expected 3"));
  o = {};
  o.relaxation = 2.5;
  EXPECT_THAT(fault(p, o), HasSubstr("relaxation must lie in (0, 2), got 2.5"));
  o = {};
  o.tolerance = -1;
  EXPECT_THAT(fault(p, o), HasSubstr("tolerance"));
  EXPECT_THAT(fault(AssembledProblem{}, {}), HasSubstr("no contacts"));
  AssembledProblem short_rows = p;
  short_rows.row_start.pop_back();
  EXPECT_THAT(fault(short_rows, {}), HasSubstr("row_start has 1 values, expected 2"));
  AssembledProblem bad = p;
  bad.q[1] = std::nan("");
  EXPECT_THAT(fault(bad, {}), HasSubstr("q holds a value that is not finite"));
  try {
    make_assembled_solver("nlg");
    FAIL();
  } catch (const AssembledError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"nlg\" is not known"));
    EXPECT_THAT(error.what(), HasSubstr("nlgs"));
  }
}

}  // namespace
}  // namespace scree
