// Alternating directions with exact friction: one loop, in which the velocity that sliding adds to
// the normal rows is that of each iteration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/assembled/assembled_solver.h"
#include "tests/assembled_samples.h"

namespace scree {
namespace {

/// Largest violation of Coulomb's law, written from the law: open contacts separate, others do not
/// approach, stick below the bound and slide against the friction at it.
double coulomb_error(const AssembledProblem& p, const std::vector<double>& r) {
  const std::vector<double> u = fixtures::velocity(p, r);
  double largest = 0;
  for (int c = 0; c < p.contact_count; ++c) {
    const double* rc = &r[3 * c];
    const double* uc = &u[3 * c];
    const double friction = std::hypot(rc[1], rc[2]), sliding = std::hypot(uc[1], uc[2]);
    const double bound = p.mu[c] * rc[0];
    largest = std::max({largest, -rc[0], -uc[0], std::min(rc[0], uc[0]), friction - bound,
                        std::min(bound - friction, sliding)});
    // Power of friction while it slides: -|r_t| |u_t|.
    largest =
        std::max(largest, std::min(sliding, rc[1] * uc[1] + rc[2] * uc[2] + friction * sliding));
  }
  return largest;
}

AssembledResult solve(const AssembledProblem& p, AssembledModel model = AssembledModel::exact,
                      int max_iterations = 0) {
  AssembledOptions o;
  o.model = model;
  o.tolerance = 1e-11;
  o.max_iterations = max_iterations;
  o.max_seconds = 30;
  return make_assembled_solver("admm")->solve(p, o);
}

/// A convex solve inside of each iteration would take many iterations in one, and factors for each.
TEST(AssembledAdmm, OneIterationIsOneSolveWithFactors) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const AssembledProblem p =
        assembled_form(fixtures::random_local_problem(3, 12, seed % 2 == 0, seed));
    const AssembledResult result = solve(p);
    SCOPED_TRACE(seed);
    EXPECT_EQ(result.status, AssembledStatus::converged) << result.residual.relative;
    EXPECT_LE(coulomb_error(p, result.r), 1e-8);
    EXPECT_LE(result.factorizations, 12);
    // Checks, one in ten iterations, are all that takes products.
    EXPECT_LE(result.applications, result.iterations / 10 + 3);
  }
}

TEST(AssembledAdmm, StopsAtTheLimitOfIterationsThatItIsGiven) {
  const AssembledProblem p = assembled_form(fixtures::random_local_problem(3, 12, true, 2));
  const AssembledResult result = solve(p, AssembledModel::exact, 5);
  EXPECT_EQ(result.status, AssembledStatus::iteration_limit);
  EXPECT_EQ(result.iterations, 5);
  EXPECT_LE(result.factorizations, 1);
}

TEST(AssembledAdmm, AnUnsymmetricOperatorIsFactorizedAsItIs) {
  AssembledProblem p = assembled_form(fixtures::random_local_problem(3, 8, true, 5));
  for (int c = 0; c < p.contact_count; ++c) {
    p.diagonal(c)[5] += 0.05 * p.diagonal(c)[4];
    p.diagonal(c)[7] -= 0.05 * p.diagonal(c)[4];
  }
  const AssembledResult result = solve(p);
  EXPECT_EQ(result.status, AssembledStatus::converged) << result.residual.relative;
  EXPECT_LE(coulomb_error(p, result.r), 1e-8);
  EXPECT_LE(result.factorizations, 12);
}

/// Of a scale of 1, so that W + D has a column of zeros.
TEST(AssembledAdmm, FactorsOfAnUnsymmetricOperatorThatFailAreNotedAsSingular) {
  const Block3 unsymmetric{2, 0, 0, 0, -1, 1, 0, 0, 2}, indefinite{2, 0, 0, 0, -1, 0, 0, 0, 2};
  const AssembledResult lu = solve(fixtures::one_contact(unsymmetric, {-1, 1, 0}, 0.3));
  EXPECT_EQ(lu.status, AssembledStatus::singular);
  EXPECT_EQ(lu.note, "W + rho D is singular to rounding");
  const AssembledResult cholesky = solve(fixtures::one_contact(indefinite, {-1, 1, 0}, 0.3));
  EXPECT_EQ(cholesky.status, AssembledStatus::singular);
  EXPECT_EQ(cholesky.note, "W is not semidefinite");
}

/// Masses of 1 on top of each other come down with a speed of 1 and stay: all contacts stick.
TEST(AssembledAdmm, ATowerIsCarriedWithFewFactorizations) {
  const int count = 60;
  const auto unit = [](double x) { return Block3{x, 0, 0, 0, x, 0, 0, 0, x}; };
  std::vector<PlacedBlock> blocks;
  for (int c = 0; c < count; ++c) {
    blocks.push_back({c, c, unit(c == 0 ? 1 : 2)});
    if (c == 0) continue;
    blocks.push_back({c, c - 1, unit(-1)});
    blocks.push_back({c - 1, c, unit(-1)});
  }
  std::vector<double> q(3 * count, 0.0);
  q[0] = -1;
  const AssembledProblem p = assemble(count, blocks, q, std::vector<double>(count, 0.5));
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    const AssembledResult result = solve(p, model);
    EXPECT_EQ(result.status, AssembledStatus::converged) << result.residual.relative;
    for (int c = 0; c < count; ++c) EXPECT_NEAR(result.r[3 * c], count - c, 1e-6);
    EXPECT_LE(result.iterations, 200);
    EXPECT_LE(result.factorizations, 12);
  }
}

}  // namespace
}  // namespace scree
