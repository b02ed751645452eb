// References that velocities are measured against.
#include <gtest/gtest.h>

#include "host/solve/solve_problem.h"
#include "tests/assembled_samples.h"

namespace scree {
namespace {

/// A problem of stored matrices; `bend` is added above the diagonal and taken away below it.
ReadyProblem random_problem(double bend) {
  StoredProblem stored;
  stored.form = fixtures::random_local_problem(3, 8, false, 12);
  ReadyProblem problem = ready("random", stored);
  AssembledProblem& form = problem.problem;
  for (int c = 0; c < 8; ++c)
    for (int k = form.row_start[c]; k < form.row_start[c + 1]; ++k)
      for (double& w : form.block[k])
        w += form.column[k] > c ? bend : form.column[k] < c ? -bend : 0;
  problem.asymmetry = asymmetry(form);
  return problem;
}

/// Errors at the end of a second run of the same solver.
AssembledCurvePoint against_itself(ReadyProblem problem, AssembledModel model) {
  AssembledOptions options;
  options.model = model;
  options.tolerance = 1e-12;
  const SolverRun reference = find_reference(problem, "proximal", options);
  EXPECT_LE(reference.result.residual.relative, 1e-12);
  EXPECT_EQ(problem.reference_model, model);
  const SolverRun run = run_solvers(problem, {"proximal"}, options).front();
  EXPECT_GT(run.curve.front().velocity_error, 1e-3);
  EXPECT_GT(run.curve.front().kinetic_error, 1e-3);
  return run.curve.back();
}

TEST(FindReference, IsWhatOtherRunsConvergeTo) {
  for (const double bend : {0.0, 0.5}) {
    for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
      const AssembledCurvePoint last = against_itself(random_problem(bend), model);
      EXPECT_LE(last.velocity_error, 1e-9) << "W unsymmetric by " << bend;
      EXPECT_LE(last.kinetic_error, 1e-16);
    }
  }
}

TEST(FindReference, IsOfOneModelOnly) {
  ReadyProblem problem = random_problem(0);
  AssembledOptions options;
  options.model = AssembledModel::convex;
  find_reference(problem, "interior_point", options);
  options.model = AssembledModel::exact;
  EXPECT_EQ(run_solvers(problem, {"nlgs"}, options).front().curve.back().velocity_error, -1);
}

}  // namespace
}  // namespace scree
