// Solvers of the convex model on the assembled operator against the dense oracle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "host/problems/assembled_form.h"
#include "host/problems/matrix_form.h"
#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/cone_vectors.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using fixtures::oracle_of;
using fixtures::random_body_problem;

/// A solver and how close it is asked to come.
struct Case {
  const char* solver;
  double tolerance;  ///< on AssembledResidual::relative
  int iterations;    ///< most
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.solver; }

class ConvexSolver : public ::testing::TestWithParam<Case> {
 protected:
  AssembledResult solve(const AssembledProblem& p, std::vector<double> guess = {}) const {
    AssembledOptions options;
    options.model = AssembledModel::convex;
    options.tolerance = GetParam().tolerance;
    options.max_iterations = GetParam().iterations;
    options.guess = std::move(guess);
    options.max_seconds = 20;
    return make_assembled_solver(GetParam().solver)->solve(p, options);
  }
};
INSTANTIATE_TEST_SUITE_P(Solvers, ConvexSolver,
                         ::testing::Values(Case{"interior_point", 1e-12, 100},
                                           Case{"gauss_seidel", 1e-10, 100000},
                                           Case{"apgd", 1e-10, 100000},
                                           Case{"apgd_plain", 1e-10, 100000},
                                           Case{"spg", 1e-10, 100000}, Case{"cpg", 1e-10, 100000},
                                           Case{"admm", 1e-10, 100000}),
                         [](const auto& info) { return std::string(info.param.solver); });

/// Few bodies, many contacts: W is singular in most of them, and impulses are not unique.
TEST_P(ConvexSolver, ReachesTheMinimumOfTheDenseOracle) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const BodyProblem bodies = random_body_problem(
        {.layout = seed % 2 == 0 ? ContactLayout::radial : ContactLayout::general,
         .free_count = static_cast<Index>(4 + seed % 9),
         .fixed_count = 2,
         .contact_count = static_cast<Index>(5 + seed * 35 / 50),
         .seed = seed});
    const AssembledProblem p = assembled_form(local_form(bodies));
    const oracle::Problem dense = oracle_of(bodies);
    const oracle::Solution expected = oracle::solve_convex(dense);

    const AssembledResult result = solve(p);

    EXPECT_EQ(result.status, AssembledStatus::converged) << result.note;
    EXPECT_NEAR(result.residual.objective, expected.objective,
                1e-10 * std::abs(expected.objective) + 1e-18);
    // W r is unique where r is not. Its energy does not depend on the frames of contacts.
    std::vector<double> moved;
    multiply(p, result.r, moved);
    const Eigen::VectorXd dense_moved = oracle::delassus(dense) * expected.gamma;
    EXPECT_NEAR(norm(moved), dense_moved.norm(), 1e-6 * dense_moved.norm() + 1e-12);
  }
}

/// A box on four corners: each may carry anything as long as the sum is the weight.
TEST_P(ConvexSolver, BearsTheWeightOfABoxOnFourCorners) {
  const double mass = 2, weight = 9.81e-3;  // impulse of a step of 1 ms per kg
  std::vector<PlacedBlock> blocks;
  std::vector<double> q;
  const double side = 0.5, inertia = mass / 6;
  const double corner[4][2] = {{-side, -side}, {side, -side}, {-side, side}, {side, side}};
  // Rows of a corner at (x, y, -side): n = z, t1 = x, t2 = y, of velocity + spin x arm.
  const auto rows = [&](int c) {
    const double x = corner[c][0], y = corner[c][1], z = -side;
    return std::array<std::array<double, 6>, 3>{
        {{0, 0, 1, y, -x, 0}, {1, 0, 0, 0, z, -y}, {0, 1, 0, -z, 0, x}}};
  };
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      PlacedBlock block{a, b, {}};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 6; ++k)
            block.value[3 * i + j] += rows(a)[i][k] * rows(b)[j][k] / (k < 3 ? mass : inertia);
      blocks.push_back(block);
    }
    q.insert(q.end(), {-weight, 0, 0});
  }
  const AssembledProblem p = assemble(4, blocks, q, {0.5, 0.5, 0.5, 0.5});

  const AssembledResult result = solve(p);

  double sum = 0;
  for (int c = 0; c < 4; ++c) sum += result.r[3 * c];
  EXPECT_NEAR(sum, mass * weight, 1e-10 * mass * weight);
}

TEST_P(ConvexSolver, SolvesContactsWithoutFriction) {
  const AssembledProblem p =
      assemble(2, {{0, 0, {2, 0.5, 0, 0.5, 2, 0, 0, 0, 2}}, {1, 1, {1, 0, 0, 0, 1, 0, 0, 0, 1}}},
               {-1, 3, 0, 1, 1, 0}, {0, 0.3});

  const AssembledResult result = solve(p);

  EXPECT_EQ(result.status, AssembledStatus::converged);
  EXPECT_NEAR(result.r[0], 0.5, 1e-9);
  for (std::size_t k = 1; k < 6; ++k) EXPECT_NEAR(result.r[k], 0, 1e-9) << k;
}

TEST_P(ConvexSolver, NeverCallsAProblemWithoutSolutionSolved) {
  // Two contacts press on a body that cannot move between two walls that come closer.
  const Block3 normal{1, 0, 0, 0, 1, 0, 0, 0, 1}, opposite{-1, 0, 0, 0, 1, 0, 0, 0, -1};
  const AssembledProblem p =
      assemble(2, {{0, 0, normal}, {0, 1, opposite}, {1, 0, opposite}, {1, 1, normal}},
               {-1, 0, 0, -1, 0, 0}, {0.3, 0.3});

  const AssembledResult result = solve(p);

  EXPECT_NE(result.status, AssembledStatus::converged);
  if (std::string(GetParam().solver) == "interior_point") {
    EXPECT_EQ(result.status, AssembledStatus::no_solution) << result.note;
  }
}

}  // namespace
}  // namespace scree
