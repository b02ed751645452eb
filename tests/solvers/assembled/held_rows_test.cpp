// Bilateral rows beside contacts: factors of rows that depend on each other, and all solvers that
// know them against dense elimination.
#include "solvers/assembled/held_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/problems/assembled_form.h"
#include "host/problems/matrix_form.h"
#include "solvers/assembled/assembled_solver.h"
#include "tests/held_samples.h"

namespace scree {
namespace {

using fixtures::DenseContacts;
using fixtures::HeldOptions;
using fixtures::random_held;
using testing::HasSubstr;

SymmetricRows rows_of(const Eigen::MatrixXd& m) {
  const SparseMatrix s = fixtures::sparse(m);
  return {s.row_start, s.column, s.value};
}

/// Second differences of a chain of n links, and twice the sum of all of them as one row more.
Eigen::MatrixXd chain_with_dependent_row(int n) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (int k = 0; k < n; ++k) {
    J(k, k) = 1;
    J(k, k + 1) = -1;
    J.row(n) += 2 * J.row(k);
  }
  return J * J.transpose();
}

TEST(SemidefiniteFactor, LeavesOutOneRowOfAChainThatClosesAndSolvesTheOthers) {
  for (const int n : {1, 2, 7, 200}) {
    SCOPED_TRACE(n);
    const Eigen::MatrixXd R = chain_with_dependent_row(n);
    const SemidefiniteFactor factor(rows_of(R));
    EXPECT_EQ(factor.kept().size(), static_cast<std::size_t>(n));
    EXPECT_GT(factor.least_pivot(), -1e-10);
    // A right side in the range: all rows are fulfilled, those left out as well.
    const Eigen::VectorXd b = R * Eigen::VectorXd::LinSpaced(n + 1, -1, 2);
    std::vector<double> x = fixtures::numbers(b);
    factor.solve(x);
    EXPECT_LT((R * fixtures::vector(x) - b).norm(), 1e-9 * (1 + b.norm()));
    EXPECT_EQ(std::count(x.begin(), x.end(), 0.0), 1);
  }
}

TEST(SemidefiniteFactor, IsThatOfADenseSolveWhereNothingDepends) {
  std::srand(3);
  const Eigen::MatrixXd J = Eigen::MatrixXd::Random(20, 30);
  Eigen::MatrixXd R = J * J.transpose();
  const SemidefiniteFactor factor(rows_of(R));
  EXPECT_EQ(factor.kept().size(), 20u);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(20, 1, 3);
  std::vector<double> x = fixtures::numbers(b);
  factor.solve(x);
  const Eigen::VectorXd expected = oracle::least_norm(R, b);
  EXPECT_LT((fixtures::vector(x) - expected).norm(), 1e-9 * expected.norm());
  R(4, 4) = -1;
  EXPECT_LT(SemidefiniteFactor(rows_of(R)).least_pivot(), -1e-3);
}

TEST(SemidefiniteFactor, OfAChainHasAsManyEntriesAsRows) {
  // Would take 20 GB if it filled in.
  SymmetricRows R;
  const int n = 50'000;
  for (int k = 0; k < n; ++k) {
    for (const int j : {k - 1, k, k + 1})
      if (j >= 0 && j < n) {
        R.column.push_back(j);
        R.value.push_back(j == k ? 2 : -1);
      }
    R.row_start.push_back(static_cast<int>(R.column.size()));
  }
  const SemidefiniteFactor factor(R);
  EXPECT_EQ(factor.kept().size(), static_cast<std::size_t>(n));
  // -x'' = 1: a parabola.
  std::vector<double> x(n, 1.0);
  factor.solve(x);
  const double middle = 0.5 * (n / 2) * (n / 2 + 1.0);
  EXPECT_NEAR(x[n / 2 - 1], middle, 1e-9 * middle);
}

/// Solvers that know bilateral rows and whose law is the cone.
std::vector<std::string> able_solvers() {
  std::vector<std::string> names = assembled_solver_names();
  std::erase_if(names, [](const std::string& name) {
    const AssembledTraits traits = make_assembled_solver(name)->traits();
    return !traits.holds_rows || traits.friction != "cone" || !traits.convex;
  });
  return names;
}

class HeldRowSolvers : public ::testing::TestWithParam<std::string> {
 protected:
  static AssembledOptions options(AssembledModel model) {
    AssembledOptions o;
    o.model = model;
    o.tolerance = 1e-11;
    o.max_iterations = 200'000;
    o.max_seconds = 30;
    return o;
  }
  static AssembledResult solve(const AssembledProblem& p, AssembledModel model) {
    return make_assembled_solver(GetParam())->solve(p, options(model));
  }
};
INSTANTIATE_TEST_SUITE_P(All, HeldRowSolvers, ::testing::ValuesIn(able_solvers()),
                         [](const auto& info) { return info.param; });

TEST_P(HeldRowSolvers, ReachTheMinimumOfDenseElimination) {
  for (const int dependent : {0, 3})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << dependent << " dependent, seed " << seed);
      const auto dense = random_held({.dependent = dependent, .seed = seed});
      const DenseContacts contacts(dense);
      const AssembledProblem p = assembled_form(local_form(fixtures::global_of(dense)));
      ASSERT_EQ(p.held->dependent_count(), dependent);
      const AssembledResult result = solve(p, AssembledModel::convex);
      EXPECT_EQ(result.status, AssembledStatus::converged) << result.note;
      const Eigen::VectorXd expected = contacts.solve_convex();
      ASSERT_LT(contacts.residual(expected, false), 1e-10);
      EXPECT_LT((fixtures::vector(result.r) - expected).norm(), 1e-8 * (1 + expected.norm()));
    }
}

TEST_P(HeldRowSolvers, FulfillCoulombsLawWithRowsThatHold) {
  // Plain Newton may end in a local minimum of its merit function.
  const bool may_stall = GetParam() == "newton" || GetParam() == "newton_krylov";
  for (const int dependent : {0, 3})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << dependent << " dependent, seed " << seed);
      const auto dense = random_held({.dependent = dependent, .seed = seed});
      const AssembledProblem p = assembled_form(local_form(fixtures::global_of(dense)));
      const AssembledResult result = solve(p, AssembledModel::exact);
      if (may_stall && result.status == AssembledStatus::stalled) continue;
      EXPECT_EQ(result.status, AssembledStatus::converged) << result.note;
      const Eigen::VectorXd r = fixtures::vector(result.r);
      const DenseContacts contacts(dense);
      EXPECT_LT(contacts.residual(r, true), 1e-9 * (1 + r.norm()));
      // The impulses of the rows hold them, those left out too.
      const Eigen::VectorXd l = fixtures::vector(p.held->impulses(result.r));
      const Eigen::VectorXd v = oracle::least_norm(dense.M, dense.H * r + dense.G * l + dense.f);
      EXPECT_LT((dense.G.transpose() * v + dense.b).norm(), 1e-9 * (1 + dense.b.norm()));
      EXPECT_LT((dense.H.transpose() * v + dense.w - (contacts.W * r + contacts.q)).norm(),
                1e-9 * (1 + r.norm()));
    }
}

TEST_P(HeldRowSolvers, SayThatRowsContradictEachOther) {
  const auto dense = random_held({.dependent = 2, .wrong = 0.25});
  const AssembledProblem p = assembled_form(local_form(fixtures::global_of(dense)));
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    const AssembledResult result = solve(p, model);
    EXPECT_EQ(result.status, AssembledStatus::no_solution);
    EXPECT_THAT(result.note, HasSubstr("bilateral rows contradict each other: row "));
    EXPECT_GT(result.residual.absolute, 0.01);
    EXPECT_GT(result.residual.unit_free, 0);
  }
}

TEST(HeldRows, FloatRoundingOfDependentRowsIsNoContradiction) {
  auto dense = random_held({.dependent = 3});
  dense.G = dense.G.cast<float>().cast<double>().eval();
  dense.b = dense.b.cast<float>().cast<double>().eval();
  const AssembledProblem p = assembled_form(local_form(fixtures::global_of(dense)));
  EXPECT_EQ(p.held->dependent_count(), 3);
  EXPECT_FALSE(p.held->contradict());
}

TEST(HeldRows, SolversOfOtherLawsReachWhatTheyReachByDenseElimination) {
  const auto dense = random_held({.seed = 9});
  const DenseContacts contacts(dense);
  const AssembledProblem held = assembled_form(local_form(fixtures::global_of(dense)));
  LocalProblem eliminated;
  eliminated.W = fixtures::sparse(contacts.W);
  eliminated.q = fixtures::numbers(contacts.q);
  eliminated.mu = fixtures::numbers(contacts.mu);
  const AssembledProblem whole = assembled_form(eliminated);
  AssembledOptions o;
  o.tolerance = 1e-11;
  o.max_iterations = 100'000;
  for (const char* name :
       {"newton_minmax", "newton_minmax_krylov", "cpg_box", "cpg_pyramid4", "cpg_pyramid8"}) {
    SCOPED_TRACE(name);
    const auto solver = make_assembled_solver(name);
    const AssembledResult a = solver->solve(held, o), b = solver->solve(whole, o);
    EXPECT_EQ(a.status, b.status) << a.note << b.note;
    EXPECT_LT((fixtures::vector(a.r) - fixtures::vector(b.r)).norm(), 1e-7);
  }
}

TEST(HeldRows, SolversThatDoNotKnowThemSaySo) {
  const AssembledProblem p = assembled_form(local_form(fixtures::global_of(random_held({}))));
  for (const char* name : {"pgs_box", "pgs_box_lagged", "pgs_pyramid4", "pgs_pyramid8"}) try {
      make_assembled_solver(name)->solve(p, {});
      ADD_FAILURE() << name;
    } catch (const AssembledError& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr("solver \"" + std::string(name) + "\" does not know bilateral rows"));
    }
}

}  // namespace
}  // namespace scree
