// Solvers of the assembled operator that run on backends: closed forms, redundant contacts, and
// minima that the host's interior point knows.
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <string>

#include "host/problems/matrix_form.h"
#include "solvers/assembled/backend_solver.h"
#include "solvers/assembled/krylov.h"
#include "solvers/assembled/sweep.h"
#include "solvers/assembled/sweep_order.h"
#include "tests/assembled_samples.h"
#include "tests/backend_fixture.h"
#include "tests/reference/dense_algebra.h"

namespace scree {
namespace {

constexpr AssembledModel both_models[] = {AssembledModel::convex, AssembledModel::exact};

AssembledOptions to(double tolerance, AssembledModel model) {
  AssembledOptions o;
  o.model = model;
  o.tolerance = tolerance;
  o.max_seconds = 60;
  return o;
}

class BackendSolvers : public BackendTest<double>,
                       public ::testing::WithParamInterface<std::string> {
 protected:
  void SetUp() override {
    BackendTest<double>::SetUp();
    if (IsSkipped()) return;
    solver =
        make_assembled_solver_on<TestBackend>(GetParam(), make_assembled_backend<TestBackend>(0));
    ASSERT_NE(solver, nullptr);
    cone = solver->traits().friction == "cone";
  }
  std::unique_ptr<AssembledSolver> solver;
  bool cone = true;
};
/// All but newton_krylov, which breaks down where contacts are redundant; hybrid_krylov has it.
std::vector<std::string> robust_solvers() {
  std::vector<std::string> names = assembled_solver_names(true);
  std::erase(names, "newton_krylov");
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, BackendSolvers, ::testing::ValuesIn(robust_solvers()),
                         [](const auto& info) { return info.param; });

/// A block that slides along an edge of all friction laws, first step.
TEST_P(BackendSolvers, OneSlidingContactHasItsClosedForm) {
  const double pull = 9.81 * 0.0025, mu = 0.3;
  const AssembledProblem p = fixtures::one_contact({1, 0, 0, 0, 1, 0, 0, 0, 1}, {-pull, 2, 0}, mu);
  const AssembledResult exact = solver->solve(p, to(1e-11, AssembledModel::exact));
  EXPECT_NEAR(exact.r[0], pull, 1e-9);
  EXPECT_NEAR(exact.r[1], -mu * pull, 1e-9);
  EXPECT_NEAR(exact.r[2], 0, 1e-9);
  if (!cone) return;
  EXPECT_EQ(exact.status, AssembledStatus::converged) << exact.note;
  const AssembledResult convex = solver->solve(p, to(1e-11, AssembledModel::convex));
  EXPECT_EQ(convex.status, AssembledStatus::converged) << convex.note;
  EXPECT_NEAR(2 + convex.r[1], 1.828112, 1e-6);
  EXPECT_NEAR(convex.r[0] - pull, 0.548434, 1e-6);
}

TEST_P(BackendSolvers, ABoxOnFourCornersIsCarried) {
  const double m = 3, speed = 0.01;
  const AssembledProblem p = fixtures::box_on_four_corners(m, 0.2, 0.1, speed);
  const AssembledResult result = solver->solve(p, to(1e-12, AssembledModel::exact));
  double sum = 0;
  for (int c = 0; c < 4; ++c) sum += result.r[3 * c];
  EXPECT_NEAR(sum, m * speed, 1e-10 * m * speed + 2e-12) << result.note;
}

/// Those whose law is that of the residual.
class ConeBackendSolvers : public BackendSolvers {};
std::vector<std::string> cone_solvers() {
  std::vector<std::string> names = robust_solvers();
  std::erase_if(names, [](const std::string& name) {
    return make_assembled_solver(name)->traits().friction != "cone";
  });
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, ConeBackendSolvers, ::testing::ValuesIn(cone_solvers()),
                         [](const auto& info) { return info.param; });

TEST_P(ConeBackendSolvers, RandomProblemsAreSolved) {
  for (const bool redundant : {false, true}) {
    const AssembledProblem p =
        assembled_form(fixtures::random_local_problem(3, 12, redundant, redundant ? 7 : 6));
    for (const AssembledModel model : both_models) {
      const AssembledResult result = solver->solve(p, to(1e-8, model));
      EXPECT_EQ(result.status, AssembledStatus::converged)
          << result.note << " " << result.residual.relative;
      // Of impulses that came back from the backend, measured on the host.
      EXPECT_LE(measure(p, model, result.r).relative, 1.001e-8);
    }
    const double minimum = make_assembled_solver("interior_point")
                               ->solve(p, to(1e-11, AssembledModel::convex))
                               .residual.objective;
    EXPECT_NEAR(solver->solve(p, to(1e-9, AssembledModel::convex)).residual.objective, minimum,
                1e-8 * std::abs(minimum));
  }
}

/// Enough contacts for many blocks of a device, with few colors: chains of spheres that sink.
AssembledProblem chains(int count, int length) {
  std::vector<PlacedBlock> blocks;
  std::vector<double> q, mu;
  for (int chain = 0; chain < count; ++chain) {
    for (int k = 0; k < length; ++k) {
      const int c = chain * length + k;
      blocks.push_back({c, c, {2, 0, 0, 0, 7, 0.1, 0, 0.1, 7}});
      if (k > 0) blocks.push_back({c, c - 1, {-0.9, 0.1, 0, 0, -2, 0, 0, 0, -2}});
      if (k > 0) blocks.push_back({c - 1, c, {-0.9, 0, 0, 0.1, -2, 0, 0, 0, -2}});
      q.insert(q.end(), {k == 0 ? -1.0 : -0.1, 0.3 * (chain % 3), 0.2 * (k % 2)});
      mu.push_back(0.2 + 0.1 * (k % 4));
    }
  }
  return assemble(count * length, blocks, q, mu);
}

TEST_P(BackendSolvers, ManyContactsAreSolvedTheSameOnEveryRun) {
  const AssembledProblem p = chains(1000, 4);
  const AssembledResult result = solver->solve(p, to(1e-9, AssembledModel::exact));
  if (cone) {
    EXPECT_EQ(result.status, AssembledStatus::converged)
        << result.note << " " << result.residual.relative;
  } else {
    EXPECT_EQ(result.status, AssembledStatus::stalled) << result.note;
  }
  EXPECT_EQ(solver->solve(p, to(1e-9, AssembledModel::exact)).r, result.r);
}

TEST_P(BackendSolvers, StopsAtTheLimitOfIterations) {
  const AssembledProblem p = assembled_form(fixtures::random_local_problem(3, 12, true, 7));
  AssembledOptions o = to(1e-30, AssembledModel::exact);
  o.max_iterations = 3;
  o.check_every = 1;
  std::vector<AssembledCurvePoint> curve;
  const AssembledResult result = solver->solve(p, o, &curve);
  EXPECT_EQ(result.status, AssembledStatus::iteration_limit);
  EXPECT_EQ(result.iterations, 3);
  // A hybrid checks as often as its phases do.
  EXPECT_GE(curve.size(), GetParam() == "hybrid_krylov" ? 2u : 4u);
  // A device adds products up in another order.
  const double relative = measure(p, AssembledModel::exact, result.r).relative;
  EXPECT_NEAR(relative, result.residual.relative, 1e-12 * relative);
}

TEST(BackendSolverNames, OtherNamesHaveNone) {
  EXPECT_EQ(make_assembled_solver_on<TestBackend>("interior_point", nullptr), nullptr);
  EXPECT_THAT(assembled_solver_names(true), testing::Not(testing::Contains("interior_point")));
}

class BackendSweeps : public BackendTest<double> {};

/// A sweep by colors is one contact after another in the order of the colors.
TEST_F(BackendSweeps, ByColorsAreSweepsInTheirOrder) {
  TestBackend& b = backend();
  const AssembledProblem p = chains(300, 5);
  const BlockProduct<TestBackend> product(b);
  const BackendProblem<TestBackend> on_backend(b, product, p);
  const SweepOrder<TestBackend> order(on_backend, SweepKind::by_colors);
  Buffer<TestBackend, double> r = on_backend.vector(std::vector<double>(p.q.size(), 0.0));
  const SweepContact visit{AssembledModel::exact, 1.2,
                           on_backend.rows(),     on_backend.q(),
                           on_backend.mu(),       r.view(on_backend.row_count())};
  for (int k = 0; k < 3; ++k) order.run(visit);

  std::vector<double> expected(p.q.size(), 0.0);
  const SweepContact on_host{AssembledModel::exact,
                             1.2,
                             p.rows(),
                             {p.q.data(), static_cast<Offset>(p.q.size())},
                             {p.mu.data(), static_cast<Offset>(p.mu.size())},
                             {expected.data(), static_cast<Offset>(expected.size())}};
  const BlockColoring coloring = color_blocks(p);
  EXPECT_EQ(coloring.color_count(), 2);
  for (int k = 0; k < 3; ++k)
    for (const Index c : coloring.contact) on_host(c);
  const std::vector<double> result = download(b, r.view(on_backend.row_count()));
  for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_NEAR(result[k], expected[k], 1e-12);
}

class BackendNewton : public BackendTest<double> {};

/// BiCGSTAB on A + B (W + S) with random blocks, against a dense decomposition.
TEST_F(BackendNewton, SystemsAreSolvedToTheReductionAskedFor) {
  TestBackend& b = backend();
  const int n = 40;
  const AssembledProblem p = chains(n / 4, 4);
  std::mt19937 generator(9);
  std::normal_distribution<double> normal;
  std::vector<Block3> by_r(n), by_u(n), inverse(n);
  std::vector<double> shift(n), right(3 * n);
  for (double& x : right) x = normal(generator);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (int c = 0; c < n; ++c) {
    shift[c] = 0.01 * (c % 5);
    for (int k = 0; k < 9; ++k) {
      by_r[c][k] = (k % 4 == 0 ? 1.0 : 0.0) + 0.1 * normal(generator);
      by_u[c][k] = (k % 4 == 0 ? 0.5 : 0.0) + 0.05 * normal(generator);
    }
    for (int k = p.row_start[c]; k < p.row_start[c + 1]; ++k)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int l = 0; l < 3; ++l)
            J(3 * c + i, 3 * p.column[k] + j) += by_u[c][3 * i + l] * p.block[k][3 * l + j];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        J(3 * c + i, 3 * c + j) += by_r[c][3 * i + j] + by_u[c][3 * i + j] * shift[c];
    Block3 own;
    for (int k = 0; k < 9; ++k) own[k] = J(3 * c + k / 3, 3 * c + k % 3);
    inverse[c] = inverse_block(own);
  }
  const BlockProduct<TestBackend> product(b);
  const BackendProblem<TestBackend> on_backend(b, product, p);
  Buffer<TestBackend, Block3> A(b), B(b), M(b);
  Buffer<TestBackend, double> S(b);
  upload(b, by_r, A);
  upload(b, by_u, B);
  upload(b, inverse, M);
  upload(b, shift, S);
  AssembledOptions options;
  AssembledMonitor monitor(p, options, nullptr);
  BlockKrylov<TestBackend> krylov(on_backend);
  upload(b, right.data(), krylov.right_side());
  const double reached =
      krylov.solve({A.view(), B.view(), M.view(), S.view()}, 1e-10, 200, monitor);
  EXPECT_LE(reached, 1e-10);
  const std::vector<double> x = download(b, krylov.solution());
  const Eigen::VectorXd expected =
      oracle::least_norm(J, Eigen::Map<const Eigen::VectorXd>(right.data(), 3 * n));
  for (int k = 0; k < 3 * n; ++k) EXPECT_NEAR(x[k], expected(k), 1e-8);
  EXPECT_GT(monitor.applications(), 0);
}

/// Few iterations where no contact is redundant, as Newton's are.
TEST_F(BackendNewton, ConvergesInFewIterations) {
  const auto solver = make_assembled_solver_on<TestBackend>("newton_krylov",
                                                            make_assembled_backend<TestBackend>(0));
  const AssembledProblem p = chains(200, 4);
  for (const AssembledModel model : both_models) {
    const AssembledResult result = solver->solve(p, to(1e-10, model));
    EXPECT_EQ(result.status, AssembledStatus::converged) << result.note;
    EXPECT_LE(result.iterations, 25);
    EXPECT_EQ(result.factorizations, 0);
    EXPECT_LE(measure(p, model, result.r).relative, 1.001e-10);
  }
}

std::unique_ptr<AssembledSolver> min_max_newton() {
  return make_assembled_solver_on<TestBackend>("newton_minmax_krylov",
                                               make_assembled_backend<TestBackend>(0));
}

TEST_F(BackendNewton, SolvesTheMinMaxFormOfBoxFrictionAsWithFactors) {
  const AssembledProblem p = chains(200, 4);
  const AssembledOptions o = to(1e-12, AssembledModel::exact);
  const AssembledResult result = min_max_newton()->solve(p, o);
  EXPECT_EQ(result.note, "solved with box friction, not the cone");
  EXPECT_LE(result.iterations, 25);
  EXPECT_EQ(result.factorizations, 0);
  EXPECT_LE(fixtures::box_friction_error(p, result.r), 1e-9);
  const AssembledResult direct = make_assembled_solver("newton_minmax")->solve(p, o);
  EXPECT_EQ(direct.note, result.note);
  for (std::size_t k = 0; k < direct.r.size(); ++k)
    EXPECT_NEAR(result.r[k], direct.r[k], 1e-8) << k;
}

/// The last iterate counts, also between two checks.
TEST_F(BackendNewton, LooksWhereItEnds) {
  const AssembledProblem p = chains(50, 4);
  AssembledOptions o = to(1e-12, AssembledModel::exact);
  o.check_every = 100;
  const AssembledResult result = min_max_newton()->solve(p, o);
  EXPECT_EQ(result.note, "solved with box friction, not the cone");
  EXPECT_GT(result.iterations, 0);
  EXPECT_LE(fixtures::box_friction_error(p, result.r), 1e-9);
}

TEST_F(BackendNewton, SaysHowItFailedInTheMinMaxForm) {
  const auto solver = min_max_newton();
  const auto solve = [&](const AssembledProblem& p) {
    return solver->solve(p, to(1e-11, AssembledModel::exact));
  };
  // Seeds found by a search over random contacts with much friction.
  const AssembledResult trapped = solve(fixtures::one_random_contact(428));
  EXPECT_EQ(trapped.status, AssembledStatus::stalled);
  EXPECT_EQ(trapped.note, "trapped at a kink or local minimum of the merit function");
  const AssembledResult misled = solve(fixtures::one_random_contact(111));
  EXPECT_EQ(misled.status, AssembledStatus::stalled);
  EXPECT_EQ(misled.note, "no descent of the merit function along the Newton step");
  const AssembledResult redundant = solve(fixtures::doubled_contact(0.2));
  EXPECT_EQ(redundant.status, AssembledStatus::singular);
  EXPECT_EQ(redundant.note, "no solution of the linear system is found");
  const AssembledResult convex = solver->solve(chains(2, 2), to(1e-8, AssembledModel::convex));
  EXPECT_EQ(convex.status, AssembledStatus::unsupported);
  EXPECT_GT(convex.residual.relative, 1e-3) << "of the guess, which it gives back";
}

}  // namespace
}  // namespace scree
