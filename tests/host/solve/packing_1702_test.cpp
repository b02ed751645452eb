// The problem of 1702 contacts, mu = 0.8: figures that solvers have to reach. The page
// docs/results/packing_1702.md has all solvers.
#include <gtest/gtest.h>

#include <cmath>

#include "host/io/problem_file.h"
#include "host/solve/solve_problem.h"

namespace scree {
namespace {

class Packing1702 : public testing::Test {
 protected:
  Packing1702()
      : problem_(ready("packing_1702",
                       read_problem(SCREE_SOURCE_DIR "/bench/problems/packing_1702.hdf5"))) {
    options_.tolerance = 1e-10;
  }

  ReadyProblem problem_;
  AssembledOptions options_;
};

TEST_F(Packing1702, HasItsSize) {
  EXPECT_EQ(problem_.problem.contact_count, 1702);
  for (const double mu : problem_.problem.mu) EXPECT_EQ(mu, 0.8);
  EXPECT_LT(problem_.asymmetry, 1e-12);
}

TEST_F(Packing1702, ApgdReachesVelocities) {
  options_.model = AssembledModel::convex;
  const SolverRun oracle = find_reference(problem_, "interior_point", options_);
  EXPECT_LE(oracle.result.residual.relative, 1e-13);
  const SolverRun run = run_solvers(problem_, {"apgd"}, options_).front();
  EXPECT_EQ(run.result.status, AssembledStatus::converged);
  EXPECT_NEAR(run.result.residual.objective, oracle.result.residual.objective,
              1e-10 * std::abs(oracle.result.residual.objective));
  // |v - v*|_M over that of the start, where v is the free velocity.
  int to_3 = 0, to_6 = 0;
  for (const AssembledCurvePoint& point : run.curve) {
    const double e = std::sqrt(point.kinetic_error / run.curve.front().kinetic_error);
    if (e > 1e-3) to_3 = point.iteration + 10;
    if (e > 1e-6) to_6 = point.iteration + 10;
  }
  EXPECT_LE(to_3, 500);
  EXPECT_LE(to_6, 5000);
}

TEST_F(Packing1702, HybridConvergesInLessThanSixtyNewtonSteps) {
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    SCOPED_TRACE(model == AssembledModel::exact ? "exact" : "convex");
    options_.model = model;
    const SolverRun run = run_solvers(problem_, {"hybrid"}, options_).front();
    EXPECT_EQ(run.result.status, AssembledStatus::converged) << run.result.residual.relative;
    EXPECT_LT(run.result.factorizations, 60);
  }
}

/// From where sweeps have led, with a weight of the size of their residual, the proximal method is
/// quick; from zero it takes 64 outer iterations.
TEST_F(Packing1702, AutoNeedsFewFactorsWithExactFriction) {
  const SolverRun run = run_solvers(problem_, {"auto"}, options_).front();
  EXPECT_EQ(run.result.status, AssembledStatus::converged) << run.result.residual.relative;
  EXPECT_LT(run.result.factorizations, 60);
}

}  // namespace
}  // namespace scree
