// Solvers of simulation steps on stored problems, against those of the assembled operator.
#include "host/solve/matrix_free.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/error.h"
#include "solvers/solver.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using fixtures::stored;

const WorldOptions kCpu{.backend = BackendKind::cpu, .precision = Precision::double_precision};

class MatrixFree : public ::testing::TestWithParam<ContactLayout> {
 protected:
  const BodyProblem problem = fixtures::random_body_problem({.layout = GetParam(),
                                                             .free_count = 30,
                                                             .contact_count = 45,
                                                             .seed = 5,
                                                             .has_adhesion = true});
  const ReadyProblem ready_problem = ready("random", stored(problem));
};

TEST_P(MatrixFree, ReachesTheMinimumOfTheAssembledProblem) {
  AssembledOptions options;
  options.model = AssembledModel::convex;
  options.tolerance = 1e-9;
  const SolverRun reference = run_solvers(ready_problem, {"auto"}, options).front();
  ASSERT_EQ(reference.result.status, AssembledStatus::converged);
  options.tolerance = 1e-7;
  for (const SolverRun& run :
       run_matrix_free(problem, ready_problem, {"apgd", "gauss_seidel"}, options, kCpu)) {
    EXPECT_EQ(run.result.status, AssembledStatus::converged) << run.solver;
    EXPECT_LE(run.result.residual.relative, 1e-7);
    EXPECT_NEAR(run.result.residual.objective, reference.result.residual.objective,
                1e-6 * std::abs(reference.result.residual.objective))
        << run.solver;
    EXPECT_EQ(run.curve.back().iteration, run.result.iterations);
    EXPECT_GT(run.curve.size(), 4u);
    EXPECT_LT(run.curve.back().residual.relative, run.curve.front().residual.relative);
  }
}

TEST_P(MatrixFree, TheFixedPointReachesCoulombsLaw) {
  AssembledOptions options;
  options.tolerance = 1e-6;
  const SolverRun run = run_matrix_free(problem, ready_problem, {"apgd"}, options, kCpu).front();
  EXPECT_EQ(run.result.status, AssembledStatus::converged);
  EXPECT_LE(run.result.residual.relative, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Layouts, MatrixFree,
                         ::testing::Values(ContactLayout::radial, ContactLayout::general),
                         [](const auto& p) { return std::string(to_string(p.param)); });

/// Rolling friction: six rows a contact, which no W of the assembled solvers has.
TEST(MatrixFreeRuns, RollingFrictionReachesTheOraclesMinimum) {
  const BodyProblem problem = fixtures::random_body_problem(
      {.layout = ContactLayout::rolling, .free_count = 12, .contact_count = 20, .seed = 3});
  const ReadyProblem ready_problem = ready_matrix_free("rolling", stored(problem));
  EXPECT_THROW(ready("rolling", stored(problem)), InputError);
  AssembledOptions options;
  options.model = AssembledModel::convex;
  options.tolerance = 1e-8;
  const oracle::Problem dense = fixtures::oracle_of(problem);
  const oracle::Solution expected = oracle::solve_convex(dense);
  for (const SolverRun& run :
       run_matrix_free(problem, ready_problem, {"apgd", "gauss_seidel"}, options, kCpu)) {
    EXPECT_EQ(run.result.status, AssembledStatus::converged) << run.solver;
    EXPECT_NEAR(run.result.residual.objective, expected.objective,
                1e-6 * std::abs(expected.objective))
        << run.solver;
    EXPECT_EQ(run.result.r.size(), 6u * 20);
    EXPECT_LT(run.curve.back().residual.relative, 1e-3 * run.curve.front().residual.relative);
  }
  options.model = AssembledModel::exact;
  options.tolerance = 1e-6;
  const SolverRun exact = run_matrix_free(problem, ready_problem, {"apgd"}, options, kCpu).front();
  ASSERT_EQ(exact.result.status, AssembledStatus::converged);
  // The best impulses, world vectors, as the oracle judges them.
  std::vector<Eigen::Vector3d> world;
  for (std::size_t k = 0; k < exact.result.r.size(); k += 3)
    world.emplace_back(exact.result.r[k], exact.result.r[k + 1], exact.result.r[k + 2]);
  const double free = oracle::right_side(dense).norm() / std::sqrt(20);
  EXPECT_LE(oracle::residual(dense, oracle::rows_from_world(dense, world)).exact_rms, 2e-6 * free);
}

TEST(MatrixFreeRuns, AGoodGuessIsTaken) {
  BodyProblem problem = fixtures::random_body_problem({.free_count = 20, .contact_count = 30});
  AssembledOptions options;
  options.model = AssembledModel::convex;
  options.tolerance = 1e-8;
  const ReadyProblem cold = ready("cold", stored(problem));
  const auto uploaded = upload_matrix_free(problem, kCpu);
  problem.impulse = uploaded->solve("apgd", AssembledModel::convex, {}, 20000, 0).impulse;
  const ReadyProblem warm = ready("warm", stored(problem));
  const SolverRun from_zero = run_matrix_free(problem, cold, {"apgd"}, options, kCpu).front();
  options.guess = warm.guess;
  const SolverRun from_guess = run_matrix_free(problem, warm, {"apgd"}, options, kCpu).front();
  EXPECT_EQ(from_guess.result.status, AssembledStatus::converged);
  EXPECT_EQ(from_guess.curve.size(), 1u);
  EXPECT_GT(from_zero.curve.size(), 3u);
}

TEST(MatrixFreeRuns, TheIterationLimitIsAStatus) {
  const BodyProblem problem =
      fixtures::random_body_problem({.free_count = 20, .contact_count = 60});
  AssembledOptions options;
  options.model = AssembledModel::convex;
  options.tolerance = 0;
  options.max_iterations = 12;
  const SolverRun run =
      run_matrix_free(problem, ready("random", stored(problem)), {"jacobi"}, options, kCpu).front();
  EXPECT_EQ(run.result.status, AssembledStatus::iteration_limit);
  std::vector<int> limits;
  for (const AssembledCurvePoint& point : run.curve) limits.push_back(point.iteration);
  EXPECT_EQ(limits, (std::vector<int>{1, 2, 3, 5, 7, 10, 12}));
}

}  // namespace
}  // namespace scree
