// Bilateral rows of stored problems: with bodies, as matrices, and as a step of a scene with joints
// hands them out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <map>
#include <random>

#include "host/problems/assembled_form.h"
#include "host/problems/matrix_form.h"
#include "host/solve/solve_problem.h"
#include "tests/held_samples.h"
#include "tests/host/input_files.h"
#include "tests/physics/joint_scenes.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using namespace physics;
using fixtures::dense;
using fixtures::DenseContacts;
using fixtures::random_body_problem;
using fixtures::random_held;
using test::refusal;
using testing::HasSubstr;

/// Free bodies that spin, contacts, and rows between some of them and with bodies that do not move.
BodyProblem random_jointed(unsigned seed, int rows) {
  BodyProblem p = random_body_problem({.layout = ContactLayout::general,
                                       .free_count = 6,
                                       .fixed_count = 2,
                                       .contact_count = 5,
                                       .seed = seed,
                                       .has_adhesion = true});
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Vec3d{normal(generator), normal(generator), normal(generator)};
  };
  for (int k = 0; k < rows; ++k) {
    BilateralRow row;
    row.body_a = k % p.free_count;
    row.body_b = std::min(row.body_a + 1 + k % 3, p.body_count() - 1);
    row.arm_a = vector();
    row.arm_b = vector();
    if (k % 3 != 0) row.force = vector();
    if (k % 3 != 1) row.moment = vector();
    row.bias = normal(generator);
    row.impulse = normal(generator);
    p.bilateral.push_back(row);
  }
  return p;
}

/// What a row says of the rates of all bodies, as body_problem.h writes it.
double velocity_of(const BilateralRow& row, const std::vector<Twist<double>>& rates) {
  const Twist<double>& a = rates[static_cast<std::size_t>(row.body_a)];
  const Twist<double>& b = rates[static_cast<std::size_t>(row.body_b)];
  const Vec3d linear =
      b.linear + cross(b.angular, row.arm_b) - a.linear - cross(a.angular, row.arm_a);
  return dot(row.force, linear) + dot(row.moment, b.angular - a.angular) + row.bias;
}

double& part_of(Twist<double>& twist, int axis) {
  return axis < 3 ? twist.linear[axis] : twist.angular[axis - 3];
}

TEST(BilateralRows, OfBodiesAreTheirVelocities) {
  const BodyProblem p = random_jointed(4, 7);
  EXPECT_NO_THROW(validate(p));
  const GlobalProblem global = global_form(p);
  const Eigen::MatrixXd G = dense(global.G);
  ASSERT_EQ(G.rows(), 6 * p.free_count);
  ASSERT_EQ(G.cols(), 7);
  std::vector<Twist<double>> rates = p.free_velocity;
  for (int i = 0; i < p.free_count; ++i) rates[static_cast<std::size_t>(i)] = {};
  for (std::size_t k = 0; k < p.bilateral.size(); ++k) {
    const double at_rest = velocity_of(p.bilateral[k], rates);
    EXPECT_NEAR(global.b[k], at_rest, 1e-12);
    for (int i = 0; i < p.free_count; ++i)
      for (int axis = 0; axis < 6; ++axis) {
        double& rate = part_of(rates[static_cast<std::size_t>(i)], axis);
        rate = 1;
        EXPECT_NEAR(G(6 * i + axis, static_cast<int>(k)),
                    velocity_of(p.bilateral[k], rates) - at_rest, 1e-12);
        rate = 0;
      }
  }
}

TEST(BilateralRows, AreTheSameInBothFormsAndInTheGuess) {
  const BodyProblem p = random_jointed(5, 6);
  const LocalProblem direct = local_form(p), through = local_form(global_form(p));
  EXPECT_LT((dense(direct.V) - dense(through.V)).norm(), 1e-9 * dense(direct.V).norm());
  EXPECT_LT((dense(direct.R) - dense(through.R)).norm(), 1e-9 * dense(direct.R).norm());
  for (std::size_t k = 0; k < direct.s.size(); ++k)
    EXPECT_NEAR(direct.s[k], through.s[k], 1e-9 * (1 + std::abs(direct.s[k])));
  for (const MatrixForm form : {MatrixForm::local, MatrixForm::global}) {
    const StoredProblem stored = as_matrices(p, form);
    EXPECT_NO_THROW(validate(stored));
    const ProblemPoint& guess = stored.guesses.at(0);
    ASSERT_EQ(guess.l.size(), 6u);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(guess.l[k], p.bilateral[k].impulse);
    std::vector<double> u = multiply(direct.W, guess.r);
    const std::vector<double> by_rows = multiply(direct.V, guess.l);
    for (std::size_t k = 0; k < u.size(); ++k)
      EXPECT_NEAR(u[k] + by_rows[k] + direct.q[k], guess.u[k], 1e-9 * (1 + std::abs(guess.u[k])));
  }
}

TEST(BilateralRows, RollingFrictionBesideThemHasNoMatrices) {
  BodyProblem p = random_body_problem({.layout = ContactLayout::rolling});
  BilateralRow row;
  row.body_b = 1;
  row.force = {1, 0, 0};
  p.bilateral.push_back(row);
  EXPECT_NO_THROW(validate(p));
  EXPECT_THAT(refusal([&] { local_form(p); }), HasSubstr("rolling friction"));
  EXPECT_THAT(refusal([&] {
                ready_matrix_free("a", {p, {}, {}, {}});
              }),
              HasSubstr("bilateral rows, which --matrix-free does not know"));
}

struct BadRow {
  const char* name;
  std::function<void(BodyProblem&)> spoil;
  std::vector<const char*> words;
};
void PrintTo(const BadRow& bad, std::ostream* out) { *out << bad.name; }
class BadBilateralRow : public ::testing::TestWithParam<BadRow> {};
const double nan = std::nan("");
INSTANTIATE_TEST_SUITE_P(
    All, BadBilateralRow,
    ::testing::Values(BadRow{"FixedA",
                             [](BodyProblem& p) { p.bilateral[1].body_a = p.free_count; },
                             {"bilateral/body_a[1] is 6", "0 to 5 (a free body)"}},
                      BadRow{"NegativeA",
                             [](BodyProblem& p) { p.bilateral[0].body_a = -1; },
                             {"bilateral/body_a[0] is -1"}},
                      BadRow{"SameBody",
                             [](BodyProblem& p) { p.bilateral[2].body_b = p.bilateral[2].body_a; },
                             {"bilateral/body_b[2] is 2, expected 3 to 7"}},
                      BadRow{"NoBody",
                             [](BodyProblem& p) { p.bilateral[0].body_b = 99; },
                             {"bilateral/body_b[0] is 99"}},
                      BadRow{"Arm",
                             [](BodyProblem& p) { p.bilateral[0].arm_a.y = nan; },
                             {"bilateral/arm_a[0]", "finite numbers"}},
                      BadRow{
                          "Nothing",
                          [](BodyProblem& p) { p.bilateral[0].force = p.bilateral[0].moment = {}; },
                          {"bilateral/force[0] is (0, 0, 0)", "not zero"}},
                      BadRow{"Bias",
                             [](BodyProblem& p) { p.bilateral[1].bias = nan; },
                             {"bilateral/bias[1] is nan"}},
                      BadRow{"Impulse",
                             [](BodyProblem& p) { p.bilateral[1].impulse = HUGE_VAL; },
                             {"warm_start/bilateral[1] is inf"}}),
    [](const auto& info) { return info.param.name; });

TEST_P(BadBilateralRow, IsRefused) {
  BodyProblem p = random_jointed(1, 4);
  GetParam().spoil(p);
  const std::string message = refusal([&] { validate(p); });
  for (const char* word : GetParam().words) EXPECT_THAT(message, HasSubstr(word));
}

TEST(BilateralRows, OfPlaneProblemsSolveAsDenseElimination) {
  const auto d = random_held({.contacts = 5, .held = 4, .dependent = 2, .dimension = 2, .seed = 6});
  const DenseContacts contacts(d);
  const AssembledProblem p = assembled_form(local_form(fixtures::global_of(d)));
  AssembledOptions o;
  o.model = AssembledModel::convex;
  o.tolerance = 1e-11;
  for (const char* name : {"auto", "apgd", "nlgs", "interior_point"}) {
    const AssembledResult result = make_assembled_solver(name)->solve(p, o);
    EXPECT_EQ(result.status, AssembledStatus::converged) << name;
    const Eigen::VectorXd r = fixtures::vector(from_three_rows(2, result.r));
    EXPECT_LT((r - contacts.solve_convex()).norm(), 1e-8) << name;
  }
}

TEST(BilateralRows, WithAnUnsymmetricRAreEliminatedByFullMatrices) {
  LocalProblem p = local_form(fixtures::global_of(random_held({.seed = 8})));
  p.R.value[1] += 0.1;  // of row 0 and column 1
  const AssembledProblem a = assembled_form(p);
  EXPECT_EQ(a.held, nullptr);
  const Eigen::MatrixXd W =
      dense(p.W) - dense(p.V) * oracle::least_norm(dense(p.R), dense(p.V).transpose());
  const Eigen::VectorXd r = Eigen::VectorXd::LinSpaced(W.rows(), -1, 1);
  std::vector<double> moved;
  multiply(a, fixtures::numbers(r), moved);
  EXPECT_LT((fixtures::vector(moved) - W * r).norm(), 1e-9);
}

TEST(BilateralRows, ThatNoBodiesHaveAreRefused) {
  LocalProblem p = local_form(fixtures::global_of(random_held({})));
  const int last = p.R.row_count - 1;
  p.R = compress(last + 1, last + 1, [&] {
    std::vector<MatrixEntry> entries;
    for (int k = 0; k <= last; ++k) entries.push_back({k, k, k == last ? -1.0 : 2.0});
    return entries;
  }());
  EXPECT_THAT(refusal([&] { assembled_form(p); }), HasSubstr("not positive semidefinite"));
  // V of a row whose R is zero: a velocity that the row follows and does not resist.
  p.R = compress(last + 1, last + 1, {{0, 0, 1}});
  EXPECT_THAT(refusal([&] { assembled_form(p); }), HasSubstr("not positive semidefinite"));
}

// ---- steps with joints -------------------------------------------------------------------------

/// Velocities of the free bodies by id, under impulses that a solver of stored problems finds.
struct Answer {
  Answer(const BodyProblem& bodies, const char* solver, double tolerance) {
    const AssembledProblem p = assembled_form(local_form(bodies));
    AssembledOptions o;
    o.model = AssembledModel::convex;
    o.tolerance = tolerance;
    o.max_seconds = 60;
    result = make_assembled_solver(solver)->solve(p, o);
    l = p.held->impulses(result.r);
    dependent = p.held->dependent_count();
    const GlobalProblem g = global_form(bodies);
    std::vector<double> load = multiply(g.H, result.r);
    const std::vector<double> by_rows = multiply(g.G, l);
    for (std::size_t k = 0; k < load.size(); ++k) load[k] += by_rows[k] + g.f[k];
    std::vector<oracle::SparseEntry> entries;
    for (int row = 0; row < g.M.row_count; ++row)
      for (int k = g.M.row_start[row]; k < g.M.row_start[row + 1]; ++k)
        entries.push_back({row, g.M.column[k], g.M.value[k]});
    const Eigen::VectorXd v = oracle::solve_sparse(entries, fixtures::vector(load));
    for (int i = 0; i < bodies.free_count; ++i)
      velocity[bodies.body_id[static_cast<std::size_t>(i)]] = {v(6 * i), v(6 * i + 1),
                                                               v(6 * i + 2)};
  }
  AssembledResult result;
  std::vector<double> l;
  int dependent = 0;
  std::map<int, Vec3d> velocity;
};

/// The last step of a world and the answer to its problem have the same velocities.
Answer expect_same(const World& world, const StepReport& report, const BodyProblem& problem,
                   double tolerance, const char* solver) {
  EXPECT_TRUE(report.converged);
  EXPECT_NO_THROW(validate(problem));
  Answer answer(problem, solver, 1e-3 * tolerance);
  EXPECT_EQ(answer.result.status, AssembledStatus::converged) << answer.result.note;
  EXPECT_EQ(answer.dependent, 0);
  const BodyStates states = world.states();
  double most = 0;
  for (const auto& [id, v] : answer.velocity)
    most = std::max(most, norm(v - states.velocity[static_cast<std::size_t>(id)]));
  EXPECT_LT(most, tolerance);
  return answer;
}

/// Two boxes on hinges in line, which swing into a heap of spheres.
Scene pendulum_in_a_heap() {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_box(scene, {0.1, 0, 0.3}, {0.09, 0.02, 0.02}, 1);
  add_box(scene, {0.3, 0, 0.3}, {0.09, 0.02, 0.02}, 1);
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 1, {0, 0, 0.3}, {0, 1, 0}));
  scene.joints.push_back(joint_of(JointKind::hinge, 1, 2, {0.2, 0, 0.3}, {0, 1, 0}));
  for (int k = 0; k < 4; ++k) add_sphere(scene, {0.1 + 0.07 * k, 0.001 * k, 0.25}, 0.03, 0.2);
  return scene;
}

TEST(StoredJoints, OfAPendulumThatMeetsSpheresHaveTheAnswerOfTheStep) {
  const Scene scene = pendulum_in_a_heap();
  World world(scene, cpu_options());
  int with_contacts = 0;
  for (int k = 0; k < 250; ++k) {
    if (k % 30 != 20) {
      world.step();
      continue;
    }
    SCOPED_TRACE(k);
    BodyProblem problem;
    const StepReport report = world.step(problem);
    EXPECT_EQ(problem.layout, ContactLayout::general);
    EXPECT_EQ(problem.bilateral.size(), 10u);
    if (report.contact_count == 0) continue;
    ++with_contacts;
    const Answer answer = expect_same(world, report, problem, 1e-8, "auto");
    // The force of each joint, whose rows follow each other.
    std::vector<Vec3d> force(2);
    for (std::size_t r = 0; r < problem.bilateral.size(); ++r)
      force[r / 5] = force[r / 5] + answer.l[r] * problem.bilateral[r].force;
    double sum = 0, in_run = 0;
    for (std::size_t j = 0; j < 2; ++j) {
      sum += norm2(force[j]);
      in_run += norm2(world.joints()[j].force);
    }
    EXPECT_NEAR(std::sqrt(sum), std::sqrt(in_run), 1e-6 * std::sqrt(in_run));
    EXPECT_NE(problem.bilateral[0].impulse, 0);  // the warm start is there
  }
  EXPECT_GE(with_contacts, 4);
}

TEST(StoredJoints, DoNotChangeTheRun) {
  const Scene scene = pendulum_in_a_heap();
  World plain(scene, cpu_options()), stored(scene, cpu_options());
  for (int k = 0; k < 60; ++k) {
    BodyProblem problem;
    plain.step();
    stored.step(problem);
  }
  const BodyStates a = plain.states(), b = stored.states();
  for (std::size_t i = 0; i < a.position.size(); ++i) EXPECT_EQ(a.position[i], b.position[i]);
}

/// Links on the ground that are pulled straight by the speed of the last one.
Scene chain_on_the_ground(int links) {
  Scene scene = empty_scene(1e-3, 0.3);
  solve_to(scene, 1e-9);
  add_plane(scene);
  for (int k = 0; k < links; ++k) {
    add_sphere(scene, {0.05 * k, 0, 0.02}, 0.02, 0.1);
    if (k > 0)
      scene.joints.push_back(joint_of(JointKind::ball, k, k + 1, {0.05 * k - 0.025, 0, 0.02}));
  }
  for (int k = links - 5; k < links; ++k)
    scene.bodies[static_cast<std::size_t>(k + 1)].velocity = {0, 0.5, 0};
  return scene;
}

TEST(StoredJoints, OfAChainOfAThousandLinksHaveTheAnswerOfTheStep) {
  World world(chain_on_the_ground(1000), cpu_options());
  BodyProblem problem;
  for (int k = 0; k < 3; ++k) world.step();
  const StepReport report = world.step(problem);
  ASSERT_EQ(problem.bilateral.size(), 3u * 999);
  ASSERT_GE(report.contact_count, 900);
  // Impulses are not compared: joints and friction that hold each other are not unique.
  expect_same(world, report, problem, 1e-6, "interior_point");
}

TEST(StoredJoints, ThatAreDrivenAreRefusedByName) {
  const auto message = [](const std::function<void(Joint&)>& change) {
    Scene scene = pendulum_in_a_heap();
    change(scene.joints[1]);
    World world(scene, cpu_options());
    return refusal([&] {
      BodyProblem problem;
      world.step(problem);
    });
  };
  EXPECT_THAT(message([](Joint& j) { j.friction = 1; }),
              HasSubstr("joints[1] (hinge) has friction, which files of contact problems do not "
                        "hold; expected joints without limits, motors and friction"));
  EXPECT_THAT(message([](Joint& j) { j.motor = JointMotor{}; }), HasSubstr("has a motor"));
  EXPECT_THAT(message([](Joint& j) { j.kind = JointKind::ball, j.swing = 1; }),
              HasSubstr("joints[1] (ball) has limits"));
  EXPECT_THAT(message([](Joint& j) { j.kind = JointKind::ball, j.friction = 1; }),
              HasSubstr("joints[1] (ball) has friction"));
  EXPECT_THAT(message([](Joint& j) {
                j.kind = JointKind::universal;
                j.second_axis = any_orthogonal(j.axis);
                j.second_turn.motor = JointMotor{};
              }),
              HasSubstr("joints[1] (universal) has a motor"));
  EXPECT_THAT(message([](Joint& j) { j.limits = {-1, 1}; }), HasSubstr("has limits"));
  EXPECT_THAT(message([](Joint& j) {
                j = line_of(JointKind::cable, 1, 2, {0.1, 0, 0.3}, {0.3, 0, 0.3});
              }),
              HasSubstr("joints[1] is a cable"));
  EXPECT_THAT(message([](Joint& j) {
                j = line_of(JointKind::spring, 1, 2, {0.1, 0, 0.3}, {0.3, 0, 0.3});
                j.stiffness = 1;
              }),
              HasSubstr("is a spring"));
}

}  // namespace
}  // namespace scree
