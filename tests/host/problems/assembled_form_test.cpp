// Stored problems as the assembled solvers take them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "host/error.h"
#include "host/problems/matrix_form.h"
#include "host/solve/solve_problem.h"
#include "tests/assembled_samples.h"
#include "tests/host/input_files.h"

namespace scree {
namespace {

using fixtures::random_local_problem;
using fixtures::velocity;
using test::refusal;
using testing::HasSubstr;

std::vector<double> ramp(std::size_t size) {
  std::vector<double> x(size);
  for (std::size_t k = 0; k < size; ++k) x[k] = 0.5 + 0.1 * static_cast<double>(k % 13);
  return x;
}

TEST(AssembledForm, ProductsAreThoseOfTheMatrix) {
  for (const int dimension : {2, 3}) {
    const LocalProblem local = random_local_problem(dimension, 7, false, 1);
    const AssembledProblem p = assembled_form(local);
    const std::vector<double> r = ramp(local.q.size());
    std::vector<double> expected = multiply(local.W, r);
    for (std::size_t k = 0; k < expected.size(); ++k) expected[k] += local.q[k];
    const std::vector<double> u =
        from_three_rows(dimension, velocity(p, to_three_rows(dimension, r)));
    ASSERT_EQ(u.size(), expected.size());
    for (std::size_t k = 0; k < u.size(); ++k) EXPECT_NEAR(u[k], expected[k], 1e-12);
  }
}

TEST(AssembledForm, OfBodiesGlobalAndLocalProblemsAreTheSame) {
  const BodyProblem bodies =
      fixtures::random_body_problem({.layout = ContactLayout::general, .seed = 3});
  const AssembledProblem direct = assembled_form(StoredProblem{bodies, {}, {}, {}});
  const AssembledProblem global = assembled_form(StoredProblem{global_form(bodies), {}, {}, {}});
  const std::vector<double> r = ramp(direct.q.size());
  const std::vector<double> u = velocity(direct, r), v = velocity(global, r);
  for (std::size_t k = 0; k < u.size(); ++k) EXPECT_NEAR(u[k], v[k], 1e-10);
}

TEST(AssembledForm, BilateralConstraintsAreEliminated) {
  // One contact and one constraint: u = 2 r_n + 1 l - 1, 0 = r_n + 4 l + 2 in the normal row.
  LocalProblem p;
  p.dimension = 3;
  p.W = compress(3, 3, {{0, 0, 2}, {1, 1, 2}, {2, 2, 2}});
  p.q = {-1, 0, 0};
  p.mu = {0.5};
  p.V = compress(3, 1, {{0, 0, 1}});
  p.R = compress(1, 1, {{0, 0, 4}});
  p.s = {2};
  const AssembledProblem a = assembled_form(p);
  std::vector<double> moved;
  multiply(a, {1, 0, 0}, moved);
  EXPECT_NEAR(moved[0], 2 - 0.25, 1e-15);
  EXPECT_NEAR(a.held->impulses({1, 0, 0})[0], -0.25 * (1 + 2), 1e-15);
  EXPECT_NEAR(a.q[0], -1 - 0.5, 1e-15);
  p.R = compress(1, 1, {{0, 0, 0}});
  EXPECT_THAT(refusal([&] { assembled_form(p); }), HasSubstr("not positive semidefinite"));
}

TEST(AssembledForm, AsymmetryIsMeasuredAndRemoved) {
  AssembledProblem p = assembled_form(random_local_problem(3, 4, false, 5));
  EXPECT_LE(asymmetry(p), 1e-15);
  p.block[1][2] += 0.5;
  EXPECT_GT(asymmetry(p), 1e-4);
  const AssembledProblem s = symmetrized(p);
  EXPECT_LE(asymmetry(s), 1e-15);
  const std::vector<double> r = ramp(p.q.size());
  const std::vector<double> u = velocity(p, r), v = velocity(s, r);
  double a = 0, b = 0;  // the quadratic form stays
  for (std::size_t k = 0; k < r.size(); ++k) {
    a += r[k] * u[k];
    b += r[k] * v[k];
  }
  EXPECT_NEAR(a, b, 1e-12 * std::abs(a));
}

TEST(AssembledForm, StoredGuessesAndSolutionsComeAlong) {
  StoredProblem stored;
  stored.form = random_local_problem(2, 2, false, 1);
  stored.guesses.push_back({{}, {}, {1, 2, 3, 4}, {}});
  stored.solution = ProblemPoint{{}, {5, 6, 7, 8}, {}, {}};
  const ReadyProblem p = ready("two", stored);
  EXPECT_EQ(p.guess, (std::vector<double>{1, 2, 0, 3, 4, 0}));
  EXPECT_EQ(p.reference_velocity, (std::vector<double>{5, 6, 0, 7, 8, 0}));
  const BodyProblem bodies =
      fixtures::random_body_problem({.layout = ContactLayout::general, .seed = 3});
  EXPECT_EQ(ready("bodies", StoredProblem{bodies, {}, {}, {}}).guess,
            to_rows(bodies, bodies.impulse));
}

TEST(SolverList, NamesAllOrRefuses) {
  EXPECT_EQ(parse_solver_list("all"), assembled_solver_names());
  EXPECT_EQ(parse_solver_list("nlgs,auto"), (std::vector<std::string>{"nlgs", "auto"}));
  EXPECT_THAT(refusal([] { parse_solver_list("nlgs,magic"); }),
              testing::AllOf(HasSubstr("\"magic\" is not a solver"), HasSubstr("proximal")));
  EXPECT_THAT(refusal([] { parse_solver_list("nlgs,"); }), HasSubstr("\"\" is not a solver"));
}

}  // namespace
}  // namespace scree
