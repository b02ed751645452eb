// Every registered solver against the dense oracle (cases A04 and A05), and exact
// Coulomb friction.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/solver.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"
#include "tests/solvers/exact_friction.h"

namespace scree {
namespace {

using fixtures::PlainProblem;
using fixtures::ProblemBuffers;

inline int contacts_of_small_problem(unsigned seed) { return 5 + static_cast<int>(seed * 7 % 36); }

/// Random problem number `seed`: 5 to 40 contacts, about three per free body;
/// N is singular in many.
template <class Real>
PlainProblem small_problem(ContactLayout layout, unsigned seed) {
  const int contacts = contacts_of_small_problem(seed);
  PlainProblem plain = fixtures::random_problem({.layout = layout,
                                                 .free_count = 3 + contacts / 3,
                                                 .contact_count = contacts,
                                                 .seed = seed,
                                                 .has_adhesion = seed % 3 == 0,
                                                 .only_spheres = seed % 2 == 0});
  fixtures::round_to<Real>(plain);
  return plain;
}

template <class Real>
class SolverOracleTest : public BackendTest<Real> {
 protected:
  static constexpr double kTolerance = std::is_same_v<Real, double> ? 1e-9 : 5e-5;

  void expect_oracle(ContactLayout layout) {
    std::vector<std::string> names;
    for (const std::string& name : solver_names(TestBackend::kIsDevice)) {
      names.push_back(name);
    }
    // Small problems are all launches on a device, so it gets fewer of them.
    const unsigned count = TestBackend::kIsDevice ? 12 : 50;
    for (unsigned seed = 1; seed <= count; ++seed) {
      const PlainProblem plain = small_problem<Real>(layout, seed);
      const oracle::Solution expected = oracle::solve_convex(plain.data);
      ASSERT_LE(expected.rms, 1e-12) << "oracle, seed " << seed;
      const Eigen::MatrixXd n = oracle::delassus(plain.data);
      const Eigen::VectorXd n_gamma = n * expected.gamma;
      ProblemBuffers<TestBackend, Real> buffers(this->backend(), plain);
      for (const std::string& name : names) {
        SCOPED_TRACE(name + ", seed " + std::to_string(seed));
        buffers.clear_impulses();
        const auto solver =
            make_solver<TestBackend, Real>(name, {.max_iterations = 100000, .check_every = 50});
        const SolveStats stats =
            solver->solve(this->backend(), buffers.problem(), buffers.gamma(), kTolerance);
        EXPECT_TRUE(stats.converged) << "residual " << stats.residual.rms;
        const Eigen::VectorXd gamma = oracle::rows_from_world(plain.data, buffers.impulses());
        const double objective = oracle::objective(plain.data, gamma);
        EXPECT_NEAR(objective, expected.objective,
                    this->tolerance(1e-10, 2e-5) * std::max(1e-3, std::abs(expected.objective)));
        EXPECT_NEAR(stats.residual.objective, objective,
                    this->tolerance(1e-10, 2e-5) * std::max(1e-3, std::abs(expected.objective)));
        EXPECT_LE((n * gamma - n_gamma).cwiseAbs().maxCoeff(),
                  this->tolerance(1e-6, 1e-3) * std::max(1.0, n_gamma.cwiseAbs().maxCoeff()));
        EXPECT_NEAR(stats.residual.rms, oracle::residual(plain.data, gamma).rms, 0.3 * kTolerance);
        const Eigen::VectorXd v =
            oracle::free_velocity(plain.data) +
            oracle::inverse_mass(plain.data) * oracle::jacobian(plain.data).transpose() * gamma;
        EXPECT_LE((buffers.velocities(solver->velocity()) - v).cwiseAbs().maxCoeff(),
                  this->tolerance(1e-12, 1e-4) * std::max(1.0, v.cwiseAbs().maxCoeff()));
      }
    }
  }
};
TYPED_TEST_SUITE(SolverOracleTest, Reals);

TYPED_TEST(SolverOracleTest, A04Radial) { this->expect_oracle(ContactLayout::radial); }
TYPED_TEST(SolverOracleTest, A04General) { this->expect_oracle(ContactLayout::general); }
TYPED_TEST(SolverOracleTest, A04Mixed) { this->expect_oracle(ContactLayout::mixed); }
TYPED_TEST(SolverOracleTest, A04Rolling) { this->expect_oracle(ContactLayout::rolling); }

/// A box on a plane: four corners share the weight of a body with six degrees of freedom.
TYPED_TEST(SolverOracleTest, A05RankDeficientBox) {
  const double mass = 2, h = 1e-2, weight = mass * 9.81 * h;
  PlainProblem plain;
  plain.layout = ContactLayout::general;
  plain.data.bodies[plain.add_general(mass, Eigen::Vector3d(0.2, 0.3, 0.4).asDiagonal())]
      .velocity = {0, 0, -9.81 * h};
  plain.add_fixed();
  plain.data.free_count = 1;
  for (double x : {-0.5, 0.5}) {
    for (double y : {-0.4, 0.4})
      plain.add_radial_contact(0, 1, {0, 0, -1}, 0.5).arm_a = {x, y, -0.3};
  }
  for (const std::string& name : solver_names(TestBackend::kIsDevice)) {
    SCOPED_TRACE(name);
    ProblemBuffers<TestBackend, TypeParam> buffers(this->backend(), plain);
    const auto solver = make_solver<TestBackend, TypeParam>(name, {.max_iterations = 20000});
    const bool is_double = std::is_same_v<TypeParam, double>;
    EXPECT_TRUE(
        solver->solve(this->backend(), buffers.problem(), buffers.gamma(), is_double ? 1e-13 : 1e-7)
            .converged);
    double sum = 0;
    for (const Eigen::Vector3d& g : buffers.impulses()) {
      sum += -g.z();
      // Gauss-Seidel takes the corners one after the other, so its answer need not
      // be the symmetric one.
      if (name == "apgd" || name == "jacobi") {
        EXPECT_NEAR(-g.z(), weight / 4, this->tolerance(1e-10, 1e-5) * weight);
      }
    }
    EXPECT_NEAR(sum, weight, this->tolerance(1e-10, 1e-5) * weight);
  }
}

/// De Saxce's fixed point against the same fixed point on dense matrices with
/// interior-point solves.
TYPED_TEST(SolverOracleTest, ExactCoulombOnRandomProblems) {
  const double tolerance = std::is_same_v<TypeParam, double> ? 1e-8 : 3e-4;
  for (ContactLayout layout : {ContactLayout::radial, ContactLayout::general,
                               ContactLayout::rolling, ContactLayout::mixed}) {
    // Some of the mixed ones are so badly conditioned that what float reaches says little.
    if (layout == ContactLayout::mixed && std::is_same_v<TypeParam, float>) continue;
    // The dense answer with rolling takes as long as all else where there are more than 26 contacts.
    const bool rolls = layout == ContactLayout::rolling;
    for (unsigned seed : {1, 2, 3, 4, 5, 6}) {
      if (rolls && contacts_of_small_problem(seed) > 26) continue;
      const PlainProblem plain = small_problem<TypeParam>(layout, seed);
      const oracle::Solution expected = oracle::solve_coulomb(plain.data, 1e-10, 60);
      using Solvers =
          std::vector<std::pair<const char*, std::unique_ptr<Solver<TestBackend, TypeParam>>>>;
      Solvers solvers;
      for (const char* inner : {"apgd", "gauss_seidel_colored"}) {
        auto convex = make_solver<TestBackend, TypeParam>(inner, {.max_iterations = 4000});
        solvers.emplace_back(inner, std::make_unique<CoulombFixedPoint<TestBackend, TypeParam>>(
                                        std::move(convex), 100));
      }
      solvers.emplace_back("apgd on the law itself", make_exact_solver<TestBackend, TypeParam>(
                                                         "apgd", {.max_iterations = 4000}, 100));
      for (const auto& [name, solver] : solvers) {
        SCOPED_TRACE(std::string(name) + ", layout " + std::to_string(static_cast<int>(layout)) +
                     ", seed " + std::to_string(seed));
        ProblemBuffers<TestBackend, TypeParam> buffers(this->backend(), plain);
        const SolveStats stats =
            solver->solve(this->backend(), buffers.problem(), buffers.gamma(), tolerance);
        EXPECT_TRUE(stats.converged) << "exact residual " << stats.residual.exact_rms;
        const Eigen::VectorXd gamma = oracle::rows_from_world(plain.data, buffers.impulses());
        const oracle::Residual dense = oracle::residual(plain.data, gamma);
        EXPECT_NEAR(stats.residual.exact_rms, dense.exact_rms, 0.3 * tolerance);
        EXPECT_NEAR(stats.residual.rms, dense.rms, 1e-5 + 1e-4 * dense.rms);
        // The oracle itself must have got there for its answer to count; answers may differ
        // where several exist.
        if (expected.exact_rms > 1e-8) continue;
        const Eigen::MatrixXd n = oracle::delassus(plain.data);
        EXPECT_LE((n * (gamma - expected.gamma)).cwiseAbs().maxCoeff(),
                  this->tolerance(1e-6, 1e-3) *
                      std::max(1.0, (n * expected.gamma).cwiseAbs().maxCoeff()));
      }
    }
  }
}

}  // namespace
}  // namespace scree
