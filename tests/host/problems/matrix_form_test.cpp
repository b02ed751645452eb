#include "host/problems/matrix_form.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "host/error.h"
#include "host/problems/contact_frame.h"
#include "tests/host/input_files.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using fixtures::dense;
using fixtures::oracle_of;
using fixtures::random_body_problem;
using test::refusal;
using testing::HasSubstr;

Eigen::VectorXd dense(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// Turns rows along the oracle's frames into rows along ours.
Eigen::MatrixXd from_oracle_frames(const BodyProblem& p) {
  const auto rows = static_cast<Eigen::Index>(3 * p.body_a.size());
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(rows, rows);
  for (std::size_t c = 0; c < p.body_a.size(); ++c) {
    Eigen::Matrix3d ours;
    for (std::size_t k = 0; k < 3; ++k)
      ours.col(static_cast<Eigen::Index>(k)) = fixtures::to_eigen(contact_frame(p.normal[c])[k]);
    const auto first = static_cast<Eigen::Index>(3 * c);
    turn.block<3, 3>(first, first) =
        ours.transpose() * oracle::contact_frame(fixtures::to_eigen(p.normal[c]));
  }
  return turn;
}

class MatrixForms : public ::testing::TestWithParam<ContactLayout> {
 protected:
  BodyProblem problem(bool has_adhesion = false) const {
    return random_body_problem({.layout = GetParam(),
                                .free_count = 15,
                                .fixed_count = 3,
                                .contact_count = 40,
                                .seed = 11,
                                .has_adhesion = has_adhesion});
  }
};
INSTANTIATE_TEST_SUITE_P(Layouts, MatrixForms,
                         ::testing::Values(ContactLayout::radial, ContactLayout::general),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST_P(MatrixForms, LocalFormIsTheOracles) {
  const BodyProblem p = problem();
  const LocalProblem local = local_form(p);
  EXPECT_NO_THROW(validate(local));
  const oracle::Problem o = oracle_of(p);
  const Eigen::MatrixXd turn = from_oracle_frames(p);
  const Eigen::MatrixXd W = turn * oracle::delassus(o) * turn.transpose();
  const Eigen::VectorXd q = turn * oracle::right_side(o);
  EXPECT_LE((dense(local.W) - W).cwiseAbs().maxCoeff(), 1e-13 * W.cwiseAbs().maxCoeff());
  EXPECT_LE((dense(local.q) - q).cwiseAbs().maxCoeff(), 1e-13 * q.cwiseAbs().maxCoeff());
}

TEST_P(MatrixForms, GlobalFormReducesToTheLocalOne) {
  const BodyProblem p = problem(/*has_adhesion=*/true);
  const LocalProblem direct = local_form(p);
  const LocalProblem reduced = local_form(global_form(p));
  const double scale = dense(direct.W).cwiseAbs().maxCoeff();
  EXPECT_LE((dense(direct.W) - dense(reduced.W)).cwiseAbs().maxCoeff(), 1e-12 * scale);
  EXPECT_LE((dense(direct.q) - dense(reduced.q)).cwiseAbs().maxCoeff(),
            1e-12 * dense(direct.q).cwiseAbs().maxCoeff());
  EXPECT_EQ(direct.mu, reduced.mu);
}

TEST_P(MatrixForms, AdhesionMovesTheApexToZero) {
  BodyProblem p = problem(/*has_adhesion=*/true);
  const LocalProblem shifted = local_form(p);
  std::vector<double> apex(shifted.q.size(), 0);
  for (std::size_t c = 0; c < p.adhesion.size(); ++c) apex[3 * c] = p.adhesion[c];
  std::fill(p.adhesion.begin(), p.adhesion.end(), 0.0);
  const LocalProblem plain = local_form(p);
  const std::vector<double> lifted = multiply(plain.W, apex);
  for (std::size_t k = 0; k < apex.size(); ++k)
    EXPECT_NEAR(shifted.q[k], plain.q[k] - lifted[k], 1e-13 * dense(plain.q).norm());
}

TEST_P(MatrixForms, GuessIsTheWarmStart) {
  const BodyProblem p = problem(/*has_adhesion=*/true);
  for (const MatrixForm form : {MatrixForm::local, MatrixForm::global}) {
    const StoredProblem stored = as_matrices(p, form);
    EXPECT_NO_THROW(validate(stored));
    ASSERT_EQ(stored.guesses.size(), 1u);
    const ProblemPoint& guess = stored.guesses.front();
    EXPECT_EQ(guess.v.empty(), form == MatrixForm::local);
    EXPECT_EQ(stored.info.title, "random");
    EXPECT_THAT(stored.info.math_info, HasSubstr("Cohesion"));
    const LocalProblem local = local_form(p);
    const Eigen::VectorXd u = dense(local.W) * dense(guess.r) + dense(local.q);
    EXPECT_LE((u - dense(guess.u)).cwiseAbs().maxCoeff(), 1e-12 * u.cwiseAbs().maxCoeff());
    std::vector<double> impulse = guess.r;
    for (std::size_t c = 0; c < p.adhesion.size(); ++c) impulse[3 * c] -= p.adhesion[c];
    const std::vector<Vec3d> world = to_world(p, impulse);
    for (std::size_t c = 0; c < world.size(); ++c)
      EXPECT_LE(norm(world[c] - p.impulse[c]), 1e-14 * norm(p.impulse[c]));
  }
}

TEST(MatrixForm, RollingFrictionIsRefused) {
  const BodyProblem p = random_body_problem({.layout = ContactLayout::rolling});
  EXPECT_THAT(refusal([&] { local_form(p); }), HasSubstr("rolling friction"));
  EXPECT_THAT(refusal([&] { global_form(p); }), HasSubstr("rolling friction"));
}

/// A sphere that cannot turn and moves along x only, on a floor that moves.
TEST(MatrixForm, LockedAxesLeaveTheDegreesOfFreedomAndKeepTheirRates) {
  BodyProblem p;
  p.layout = ContactLayout::general;
  p.source.time_step = 1e-3;
  p.free_count = 1;
  p.body_id = {0, 1};
  p.free_velocity = {{{1, 0, 0}, {}}, {{0.25, 0, 0.5}, {}}};
  p.general_inertia.resize(2);
  p.general_inertia[0].mass = 2;
  p.general_inertia[0].inv_mass = {0.5, 0, 0};
  p.body_a = {0};
  p.body_b = {1};
  p.normal = {{0, 0, -1}};
  p.arm_a = {{0, 0, -0.1}};
  p.arm_b = {{0.3, 0, 0}};
  p.bias = {0.125};
  p.friction = {0.5};
  p.adhesion = {0};
  p.impulse = {{}};
  const GlobalProblem global = global_form(p);
  EXPECT_EQ(dense(global.M), Eigen::MatrixXd::Constant(1, 1, 2));
  EXPECT_EQ(global.f, std::vector<double>{2});
  ASSERT_EQ(global.H.row_count, 1);
  // The floor rises at 0.5 against a body that stays: along n = -z that is -0.5, and the bias.
  EXPECT_DOUBLE_EQ(global.w[0], 0.125 - 0.5);
  const LocalProblem local = local_form(p);
  EXPECT_NEAR(dense(local.W).trace(), 0.5, 1e-15);  // along x alone
  const std::vector<Vec3d> u = to_world(p, local.q);
  EXPECT_NEAR(u[0].x, 0.25 - 1, 1e-15);
  EXPECT_NEAR(u[0].z, 0.5 - 0.125, 1e-15);
}

TEST(MatrixForm, BilateralConstraintsAreReducedToo) {
  // Two unit masses on a line; a contact pushes the first, a bar of fixed length joins them.
  GlobalProblem g;
  g.dimension = 2;
  g.M = compress(4, 4, {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}, {3, 3, 1}});
  g.H = compress(4, 2, {{0, 0, 1}, {1, 1, 1}});
  g.f = {-1, 0, 0, 0};
  g.w = {0, 0};
  g.mu = {0.5};
  g.G = compress(4, 1, {{0, 0, 1}, {2, 0, -1}});
  g.b = {0.25};
  const LocalProblem local = local_form(g);
  EXPECT_EQ(dense(local.W), Eigen::MatrixXd::Identity(2, 2));
  EXPECT_EQ(dense(local.V), (Eigen::MatrixXd(2, 1) << 1, 0).finished());
  EXPECT_EQ(dense(local.R), Eigen::MatrixXd::Constant(1, 1, 2));
  EXPECT_EQ(local.q, (std::vector<double>{-1, 0}));
  EXPECT_EQ(local.s, std::vector<double>{-0.75});
}

/// A problem of one contact on n degrees of freedom.
GlobalProblem one_contact_on(int n) {
  GlobalProblem g;
  g.H = compress(n, 3, {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}});
  g.f.assign(static_cast<std::size_t>(n), 0);
  g.w = {0, 0, 0};
  g.mu = {0.5};
  return g;
}

TEST(MatrixForm, NearlyEmptyMassIsRefusedInsteadOfFactorized) {
  GlobalProblem g = one_contact_on(100);
  g.M = compress(100, 100, {});
  EXPECT_THAT(refusal([&] { local_form(g); }), HasSubstr("M is singular: row 0 is empty"));
  g.M = compress(100, 100, {{0, 0, 1}});
  EXPECT_THAT(refusal([&] { local_form(g); }), HasSubstr("M is singular: row 1 is empty"));
  std::vector<MatrixEntry> one_column;
  for (int row = 0; row < 100; ++row) one_column.push_back({row, 0, 1});
  g.M = compress(100, 100, one_column);
  EXPECT_THAT(refusal([&] { local_form(g); }), HasSubstr("M is singular: column 1 is empty"));
}

TEST(MatrixForm, AnOperatorBeyondAllMemoryIsRefusedAndOneThatIsOnlyLargeIsNot) {
  const auto contacts_on = [](int bodies) {
    const int contacts = 15'500;
    GlobalProblem g;
    std::vector<MatrixEntry> mass, h;
    for (int k = 0; k < 3 * bodies; ++k) mass.push_back({k, k, 1});
    for (int row = 0; row < 3 * contacts; ++row) h.push_back({row % (3 * bodies), row, 1});
    g.M = compress(3 * bodies, 3 * bodies, mass);
    g.H = compress(3 * bodies, 3 * contacts, h);
    g.f.assign(static_cast<std::size_t>(3 * bodies), 0);
    g.w.assign(3 * contacts, 0.0);
    g.mu.assign(contacts, 0.5);
    return g;
  };
  EXPECT_EQ(local_form(contacts_on(500)).W.entry_count(),
            31 * 31 * 1500);  // 31 rows on each of 1,500
  GlobalProblem coupled = contacts_on(1);
  coupled.M =
      compress(3, 3, {{0, 0, 2}, {0, 1, 1}, {1, 0, 1}, {1, 1, 2}, {1, 2, 1}, {2, 1, 1}, {2, 2, 2}});
  EXPECT_THAT(refusal([&] { local_form(coupled); }), HasSubstr("at most 2^31"));
}

TEST(MatrixForm, SingularMassIsRefused) {
  GlobalProblem g;
  g.M = compress(3, 3, {{0, 0, 1}, {1, 1, 1}});
  g.H = compress(3, 3, {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}});
  g.f = {0, 0, 0};
  g.w = {0, 0, 0};
  g.mu = {0.5};
  EXPECT_THAT(refusal([&] { local_form(g); }), HasSubstr("M is singular"));
}

}  // namespace
}  // namespace scree
