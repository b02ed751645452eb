// The convex model on the problems of the FCLIB collection: the objective of first-order methods
// against the published minimum and the interior point. The files are not part of the source tree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/io/problem_file.h"
#include "host/solve/solve_problem.h"
#include "tests/host/solve/fclib_reference.h"

namespace scree {
namespace {

using physics::shared_file;

class FclibConvex : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (fclib::figures().empty())
      GTEST_SKIP() << "there is no " << shared_file("fclib/reference.csv")
                   << "; SCREE_SHARED_DATA names the folder that fclib is in";
  }
  static AssembledResult solve(const ReadyProblem& p, const std::string& solver, double tolerance,
                               int max_iterations) {
    AssembledOptions o;
    o.model = AssembledModel::convex;
    o.tolerance = tolerance;
    o.max_iterations = max_iterations;
    o.max_seconds = 200;  // for slow machines: 41 on a quiet one
    return run_solvers(p, {solver}, o).front().result;
  }
};
INSTANTIATE_TEST_SUITE_P(Solvers, FclibConvex,
                         ::testing::Values("apgd", "apgd_plain", "spg", "gauss_seidel", "cpg",
                                           "admm"),
                         [](const auto& info) { return info.param; });

/// Gauss-Seidel and CPG take minutes on this one: what they reach is 1e-5 then. SPG takes half a minute.
bool is_slow(const std::string& name) { return name.find("RockPile") == 0; }

TEST_P(FclibConvex, ReachesTheMinimumOfTheInteriorPointAndThePublishedOne) {
  const std::string solver = GetParam();
  const bool quick = solver != "gauss_seidel" && solver != "cpg" && solver != "spg";
  for (const fclib::Figures& f : fclib::figures()) {
    if (is_slow(f.name) && !quick) continue;
    SCOPED_TRACE(f.name);
    const ReadyProblem p =
        ready(f.name, read_problem(shared_file("fclib/local/" + f.name + ".hdf5")));
    const double oracle = solve(p, "interior_point", 1e-12, 0).residual.objective;
    // Ten times less takes some of them 30 times the iterations, and the minimum is within 1e-9 already.
    const AssembledResult result = solve(p, solver, is_slow(f.name) ? 1e-8 : 1e-9, 2000000);
    EXPECT_NEAR(result.residual.objective, f.convex_minimum, 1e-8 * std::abs(f.convex_minimum))
        << result.note;
    EXPECT_NEAR(result.residual.objective, oracle, 1e-8 * std::abs(oracle)) << result.note;
  }
}

class FclibOracle : public FclibConvex {};
INSTANTIATE_TEST_SUITE_P(Oracle, FclibOracle, ::testing::Values("interior_point"),
                         [](const auto& info) { return info.param; });

/// Impulses of 6e5 N s leave the collection's error, whose rho is 1, no more than 1e-12.
TEST_P(FclibOracle, ReachesAResidualOfRounding) {
  for (const fclib::Figures& f : fclib::figures()) {
    SCOPED_TRACE(f.name);
    const ReadyProblem p =
        ready(f.name, read_problem(shared_file("fclib/local/" + f.name + ".hdf5")));
    const AssembledResult result = solve(p, GetParam(), 1e-14, 0);
    EXPECT_LE(result.residual.relative, 1e-12) << result.note;
    EXPECT_NEAR(result.residual.objective, f.convex_minimum, 1e-11 * std::abs(f.convex_minimum));
  }
}

}  // namespace
}  // namespace scree
