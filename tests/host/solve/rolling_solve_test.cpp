// Problems with rolling friction in five rows a contact: the projection, the measures and the
// solvers, against the law written out.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/problems/assembled_form.h"
#include "host/problems/matrix_form.h"
#include "host/solve/solve_problem.h"
#include "solvers/rolling/rolling_measures.h"
#include "solvers/rolling/rolling_solver.h"
#include "tests/rolling_samples.h"

namespace scree {
namespace {

using Vector = Eigen::VectorXd;
using Vector5 = Eigen::Matrix<double, 5, 1>;
using fixtures::random_rolling_problem;
using fixtures::rolling_pile;
using fixtures::rolling_sphere;
using S = fixtures::RollingSphere;

/// What of the law is missed by the worst contact, by the conditions themselves: signs, bounds, and
/// no product of what excludes each other. Velocities and impulses are divided by the given sizes.
struct Missed {
  double impulse = 0;   ///< r_n < 0, |r_t| > mu r_n, |r_m| > mu_r r_n
  double velocity = 0;  ///< exact: u_n < 0; convex: u outside the dual cone
  double power = 0;     ///< exact: u_n r_n, and dissipation short of its most; convex: r.u
  double worst() const { return std::max({impulse, velocity, power}); }
};

Missed missed(const LocalProblem& p, AssembledModel model, const std::vector<double>& impulses) {
  const int rows = static_cast<int>(p.q.size());
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(rows, rows);
  for (int i = 0; i < rows; ++i)
    for (int k = p.W.row_start[i]; k < p.W.row_start[i + 1]; ++k)
      W(i, p.W.column[k]) += p.W.value[k];
  const Vector r = Eigen::Map<const Vector>(impulses.data(), rows);
  const Vector u = W * r + Eigen::Map<const Vector>(p.q.data(), rows);
  const double r_size = std::max(r.cwiseAbs().maxCoeff(), 1e-300);
  const double u_size = Eigen::Map<const Vector>(p.q.data(), rows).cwiseAbs().maxCoeff();
  Missed m;
  for (int c = 0; c < p.contact_count(); ++c) {
    const Vector5 s = r.segment<5>(5 * c), v = u.segment<5>(5 * c);
    const double r_t = s.segment<2>(1).norm(), r_m = s.tail<2>().norm();
    const double u_t = v.segment<2>(1).norm(), u_m = v.tail<2>().norm();
    const double mu = p.mu[c], mu_r = p.mu_r[c];
    m.impulse = std::max(
        {m.impulse, -s(0) / r_size, (r_t - mu * s(0)) / r_size, (r_m - mu_r * s(0)) / r_size});
    const double power_size = r_size * u_size;
    if (model == AssembledModel::exact) {
      m.velocity = std::max(m.velocity, -v(0) / u_size);
      const double slide = mu * s(0) * u_t + s.segment<2>(1).dot(v.segment<2>(1));
      const double roll = mu_r * s(0) * u_m + s.tail<2>().dot(v.tail<2>());
      m.power = std::max({m.power, std::abs(s(0) * v(0)) / power_size, std::abs(slide) / power_size,
                          std::abs(roll) / power_size});
    } else {
      m.velocity = std::max(m.velocity, (mu * u_t + mu_r * u_m - v(0)) / u_size);
      m.power = std::max(m.power, std::abs(s.dot(v)) / power_size);
    }
  }
  return m;
}

AssembledResult solve(const LocalProblem& p, const char* solver, AssembledModel model,
                      double tolerance = 1e-10) {
  AssembledOptions o;
  o.model = model;
  o.tolerance = tolerance;
  return solve_rolling(solver, rolling_form(p), o);
}

TEST(RollingCone, ProjectionIsTheOneOfMoreau) {
  // y = P + N with P in the cone, N in the polar cone and P.N = 0 is true of the projection alone.
  std::mt19937 generator(4);
  std::normal_distribution<double> normal;
  int zero = 0, inside = 0, one_bound = 0, both = 0;
  for (int sample = 0; sample < 4000; ++sample) {
    const RollingCone cone{sample % 9 == 0 ? 0 : 2 * std::abs(normal(generator)),
                           sample % 7 == 0 ? 0 : std::abs(normal(generator))};
    Vector5 y;
    for (int k = 0; k < 5; ++k) y(k) = normal(generator);
    Vector5 x = y;
    project_on_cone(cone, x.data());
    const Vector5 rest = y - x;
    const auto length = [](const Vector5& v, int at) { return v.segment<2>(at).norm(); };
    EXPECT_GE(x(0), 0);
    EXPECT_LE(length(x, 1), cone.mu * x(0) + 1e-14);
    EXPECT_LE(length(x, 3), cone.mu_r * x(0) + 1e-14);
    EXPECT_LE(rest(0) + cone.mu * length(rest, 1) + cone.mu_r * length(rest, 3), 1e-14);
    EXPECT_NEAR(rest.dot(x), 0, 1e-14);
    zero += x.norm() == 0;
    inside += rest.norm() == 0;
    const bool t = length(rest, 1) > 0, m = length(rest, 3) > 0;
    one_bound += x.norm() > 0 && t != m;
    both += x.norm() > 0 && t && m;
  }
  EXPECT_GT(std::min({zero, inside, one_bound, both}), 100);
}

TEST(RollingMeasures, AreTheDefinition) {
  const RollingProblem p = rolling_form(random_rolling_problem(6, false, 3));
  std::mt19937 generator(9);
  std::normal_distribution<double> normal;
  std::vector<double> r;
  for (int k = 0; k < 30; ++k) r.push_back((k % 5 == 0 ? 1 : 0) + 0.5 * normal(generator));
  const std::vector<double> u = contact_velocity(p, r);
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    double square = 0, q_square = 0;
    for (int c = 0; c < 6; ++c) {
      Vector5 s, v;
      for (int k = 0; k < 5; ++k) {
        s(k) = r[5 * c + k];
        v(k) = u[5 * c + k];
        q_square += p.q[5 * c + k] * p.q[5 * c + k];
      }
      if (model == AssembledModel::exact)
        v(0) += p.mu[c] * v.segment<2>(1).norm() + p.mu_r[c] * v.tail<2>().norm();
      Vector5 y = s - v;
      project_on_cone(cone_of(p, c), y.data());
      square += (s - y).squaredNorm();
    }
    const AssembledResidual found = measure(p, model, contact_scales(p), r, u);
    EXPECT_NEAR(found.absolute, std::sqrt(square), 1e-13 * std::sqrt(square));
    EXPECT_NEAR(found.relative, std::sqrt(square / q_square), 1e-13 * found.relative);
  }
}

/// The same problem in millimeters and grams.
TEST(RollingMeasures, UnitFreeIsTheSameInAllUnits) {
  GlobalProblem si = rolling_pile(3, 2, 0.4, 0.01, 6), other = si;
  const double length = 1e3, mass = 1e3;
  const auto per = [&](int row, double linear, double angular) {
    return row % 6 < 3 ? linear : angular;
  };
  for (int row = 0; row < si.M.row_count; ++row) {
    other.M.value[row] *= mass * per(row, 1, length * length);  // a diagonal
    other.f[row] *= mass * length * per(row, 1, length);
    for (int k = si.H.row_start[row]; k < si.H.row_start[row + 1]; ++k) {
      const bool arm = row % 6 >= 3 && si.H.column[k] % 5 < 3;
      if (arm) other.H.value[k] *= length;
    }
  }
  for (double& mu_r : other.mu_r) mu_r *= length;
  const RollingProblem a = rolling_form(local_form(si)), b = rolling_form(local_form(other));
  std::vector<double> r(a.q.size()), s;
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = k % 5 == 0 ? 0.02 : 1e-4 * std::sin(3.0 * k);
  for (std::size_t k = 0; k < r.size(); ++k)
    s.push_back(r[k] * mass * length * (k % 5 < 3 ? 1 : length));
  const auto of = [](const RollingProblem& p, const std::vector<double>& impulses) {
    return measure(p, AssembledModel::exact, contact_scales(p), impulses,
                   contact_velocity(p, impulses));
  };
  EXPECT_NEAR(of(a, r).unit_free, of(b, s).unit_free, 1e-12 * of(a, r).unit_free);
  EXPECT_GT(std::abs(of(a, r).relative / of(b, s).relative - 1), 0.1);
}

class RollingSolver : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, RollingSolver, ::testing::Values("auto", "nlgs", "apgd", "proximal"),
                         [](const auto& info) { return std::string(info.param); });

/// Free: spin slows by what the bounded moment takes, m R^2 resisting with I through friction.
TEST_P(RollingSolver, SphereRollsOnByTheClosedForm) {
  const double mu_r = 0.005;  // m
  const LocalProblem p = local_form(rolling_sphere(0.5, mu_r));
  const AssembledResult result = solve(p, GetParam(), AssembledModel::exact, 1e-12);
  ASSERT_EQ(result.status, AssembledStatus::converged) << result.note;
  const double slowed = mu_r * S::press / (S::inertia + S::mass * S::radius * S::radius);
  ASSERT_LT(slowed, S::speed / S::radius);
  const std::vector<double> expected{S::press, -S::mass * S::radius * slowed, 0, 0,
                                     -mu_r * S::press};
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(result.r[k], expected[k], 1e-10) << k;
  const std::vector<double> u = contact_velocity(rolling_form(p), result.r);
  EXPECT_NEAR(u[4], S::speed / S::radius - slowed, 1e-9);
  EXPECT_NEAR(u[1], 0, 1e-11);
}

TEST_P(RollingSolver, SphereStopsWhereTheMomentCanHoldIt) {
  const LocalProblem p = local_form(rolling_sphere(5, 0.5));
  const AssembledResult result = solve(p, GetParam(), AssembledModel::exact, 1e-12);
  ASSERT_EQ(result.status, AssembledStatus::converged) << result.note;
  const double spin = S::speed / S::radius;
  const std::vector<double> expected{S::press, -S::mass * S::speed, 0, 0,
                                     -(S::inertia + S::mass * S::radius * S::radius) * spin};
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(result.r[k], expected[k], 1e-10) << k;
  for (const double velocity : contact_velocity(rolling_form(p), result.r))
    EXPECT_NEAR(velocity, 0, 1e-9);
}

TEST_P(RollingSolver, SatisfiesTheLawOfRandomProblems) {
  for (const bool redundant : {false, true})
    for (unsigned seed = 1; seed <= 3; ++seed)
      for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
        const LocalProblem p = random_rolling_problem(8, redundant, seed);
        const AssembledResult result = solve(p, GetParam(), model);
        EXPECT_EQ(result.status, AssembledStatus::converged)
            << result.residual.relative << " redundant " << redundant << " seed " << seed
            << (model == AssembledModel::exact ? " exact" : " convex");
        EXPECT_LE(missed(p, model, result.r).worst(), 1e-7) << seed << redundant;
      }
}

TEST_P(RollingSolver, SatisfiesTheLawOfPiles) {
  const LocalProblem p = local_form(rolling_pile(3, 2, 0.5, 0.02, 2));
  for (const AssembledModel model : {AssembledModel::convex, AssembledModel::exact}) {
    const AssembledResult result = solve(p, GetParam(), model, 1e-8);
    EXPECT_EQ(result.status, AssembledStatus::converged) << result.residual.relative;
    EXPECT_LE(missed(p, model, result.r).worst(), 1e-6);
  }
}

TEST(RollingSolvers, OraclesSeeWrongImpulses) {
  const LocalProblem p = random_rolling_problem(8, false, 1);
  std::vector<double> r = solve(p, "auto", AssembledModel::exact).r;
  const Missed right = missed(p, AssembledModel::exact, r);
  // Rolling moments turned about: within their bounds, but they no longer resist.
  for (std::size_t k = 3; k < r.size(); k += 5) std::swap(r[k], r[k + 1]);
  EXPECT_GT(missed(p, AssembledModel::exact, r).power, 1e3 * right.worst());
  EXPECT_GT(missed(p, AssembledModel::convex, solve(p, "auto", AssembledModel::exact).r).velocity,
            1e-3);
}

TEST(RollingSolvers, UnsymmetricOperatorsHaveTheirSymmetricPartForTheConvexModel) {
  LocalProblem p = random_rolling_problem(5, false, 8), symmetric = p;
  for (int row = 0; row < 25; ++row)
    for (int k = p.W.row_start[row]; k < p.W.row_start[row + 1]; ++k)
      p.W.value[k] += p.W.column[k] > row ? 0.3 : p.W.column[k] < row ? -0.3 : 0;
  const AssembledResult bent = solve(p, "auto", AssembledModel::convex);
  EXPECT_NE(bent.note.find("W symmetrized"), std::string::npos);
  EXPECT_LE(missed(symmetric, AssembledModel::convex, bent.r).worst(), 1e-7);
  EXPECT_LE(missed(p, AssembledModel::exact, solve(p, "auto", AssembledModel::exact).r).worst(),
            1e-7);
}

TEST(RollingSolvers, ApproachThatNothingActsOnHasNoSolution) {
  LocalProblem p = random_rolling_problem(2, false, 8);
  for (int k = p.W.row_start[5]; k < p.W.row_start[6]; ++k) p.W.value[k] = 0;
  p.q[5] = -1;
  const AssembledResult result = solve(p, "auto", AssembledModel::exact);
  EXPECT_EQ(result.status, AssembledStatus::no_solution);
  EXPECT_NE(result.note.find("contact 1"), std::string::npos) << result.note;
}

TEST(RollingSolvers, MistakesOfTheCallerAreNamed) {
  const RollingProblem good = rolling_form(random_rolling_problem(2, false, 8));
  const auto fault = [](const RollingProblem& p, const AssembledOptions& o) {
    try {
      solve_rolling("nlgs", p, o);
    } catch (const AssembledError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  RollingProblem p = good;
  p.mu_r.clear();
  EXPECT_EQ(fault(p, {}), "mu_r has 0 values, expected 2");
  p = good;
  p.mu.push_back(0.5);
  EXPECT_EQ(fault(p, {}), "mu has 3 values, expected 2");
  p = good;
  p.row_start.pop_back();
  EXPECT_EQ(fault(p, {}), "row_start has 10 values, expected 11");
  p = good;
  p.row_start[4] = 1000;
  EXPECT_EQ(fault(p, {}), "row_start must ascend from 0 to 100");
  p = good;
  p.column.back() = 10;
  EXPECT_EQ(fault(p, {}), "column holds 10, expected 0 to 9");
  AssembledOptions o;
  o.tolerance = std::nan("");
  EXPECT_EQ(fault(good, o), "tolerance must not be negative, got nan");
  o = {};
  o.max_iterations = -1;
  EXPECT_EQ(fault(good, o), "max_iterations must not be negative, got -1");
  o = {};
  o.check_every = -1;
  EXPECT_EQ(fault(good, o), "check_every must not be negative, got -1");
  o = {};
  o.max_seconds = std::nan("");
  EXPECT_EQ(fault(good, o), "max_seconds must not be negative, got nan");
  EXPECT_EQ(fault(good, {}), "no error");
}

TEST(RollingProblems, BilateralConstraintsAreEliminated) {
  // The sphere on a rail: it cannot move along y nor turn about x, and so r_t2 and r_m1 rest.
  GlobalProblem p = rolling_sphere(0.5, 0.005);
  p.f[1] = 0.2;
  p.G = compress(6, 2, {{1, 0, 1}, {3, 1, 1}});
  p.b = {0, 0};
  StoredProblem stored;
  stored.form = p;
  const ReadyProblem problem = ready("rail", stored);
  ASSERT_TRUE(problem.rolling);
  AssembledOptions o;
  o.tolerance = 1e-12;
  const SolverRun run = run_solvers(problem, {"nlgs"}, o).front();
  const std::vector<double> u = velocity_of(problem, o.model, run.result.r);
  EXPECT_NEAR(u[2], 0, 1e-11);
  EXPECT_NEAR(u[4],
              S::speed / S::radius - 0.005 * S::press / (1.4 * S::mass * S::radius * S::radius),
              1e-9);
}

TEST(RollingProblems, ReferencesAreInTheirOwnRows) {
  StoredProblem stored;
  stored.form = random_rolling_problem(6, false, 2);
  ReadyProblem problem = ready("random", stored);
  AssembledOptions o;
  o.tolerance = 1e-12;
  const SolverRun reference = find_reference(problem, "nlgs", o);
  EXPECT_LE(reference.result.residual.relative, 1e-12);
  const SolverRun run = run_solvers(problem, {"auto"}, o).front();
  EXPECT_GT(run.curve.front().velocity_error, 1e-3);
  EXPECT_LE(run.curve.back().velocity_error, 1e-9);
  EXPECT_LE(run.curve.back().kinetic_error, 1e-15);
}

}  // namespace
}  // namespace scree
