// One-contact problems against closed forms, and the measures that judge all solvers.
#include "solvers/assembled/one_contact.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/assembled_samples.h"

namespace scree {
namespace {

using fixtures::one_contact;

std::array<double, 3> solved(AssembledModel model, const Block3& W, const std::array<double, 3>& q,
                             double mu, std::array<double, 3> r = {7, 8, 9}) {
  solve_one_contact(model, W, q.data(), mu, r.data());
  return r;
}

constexpr AssembledModel models[] = {AssembledModel::convex, AssembledModel::exact};

/// A block pressed on a plane at 0.01 m/s and sliding at 2 m/s, k times easier to
/// slide than to lift.
Block3 block(double k) { return {1, 0, 0, 0, k, 0, 0, 0, k}; }

TEST(OneContact, OpensWhereItSeparates) {
  EXPECT_EQ(solved(AssembledModel::exact, block(1), {0.1, 5, 0}, 0.3),
            (std::array<double, 3>{0, 0, 0}));
  // The convex law asks for u_n >= mu |u_t|.
  EXPECT_EQ(solved(AssembledModel::convex, block(1), {1.6, 5, 0}, 0.3),
            (std::array<double, 3>{0, 0, 0}));
  EXPECT_GT(solved(AssembledModel::convex, block(1), {1.4, 5, 0}, 0.3)[0], 0);
}

TEST(OneContact, SticksWithinTheCone) {
  const Block3 W{2, 0.3, -0.1, 0.3, 3, 0.2, -0.1, 0.2, 1.5};
  const std::array<double, 3> stick{0.8, 0.2, -0.1};
  std::array<double, 3> q;
  for (std::size_t i = 0; i < 3; ++i)
    q[i] = -(W[3 * i] * stick[0] + W[3 * i + 1] * stick[1] + W[3 * i + 2] * stick[2]);
  for (const AssembledModel model : models) {
    const auto r = solved(model, W, q, 0.5);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(r[i], stick[i], 1e-14);
  }
}

/// First step of a sliding block (k = 1) and ball (k = 7/2): g h = 0.024525 m/s.
TEST(OneContact, FirstStepsOfSlidingBodiesHaveTheirClosedForms) {
  const double g_h = 9.81 * 0.0025, v0 = 2;
  for (const double k : {1.0, 3.5}) {
    const double mu = k > 1 ? 0.2 : 0.3;
    const double u_t = (v0 - k * mu * g_h) / (1 + k * mu * mu);
    const auto convex = solved(AssembledModel::convex, block(k), {-g_h, v0, 0}, mu);
    EXPECT_NEAR(convex[0], mu * u_t + g_h, 1e-13);
    EXPECT_NEAR(convex[1], -mu * convex[0], 1e-13);
    const auto exact = solved(AssembledModel::exact, block(k), {-g_h, v0, 0}, mu);
    EXPECT_NEAR(exact[0], g_h, 1e-15);
    EXPECT_NEAR(exact[1], -mu * g_h, 1e-15);
    EXPECT_NEAR(exact[2], 0, 1e-15);
  }
  const auto published = solved(AssembledModel::convex, block(1), {-g_h, v0, 0}, 0.3);
  EXPECT_NEAR(v0 + published[1], 1.828112, 1e-6);
  EXPECT_NEAR(published[0] - g_h, 0.548434, 1e-6);
}

/// A rod whose lower end is on the floor: friction couples to the normal. Third row: nothing.
TEST(OneContact, PainleveRod) {
  const Block3 W{1.6, -1.2, 0, -1.2, 3.4, 0, 0, 0, 2.5};
  const double g_h = 9.81e-3;
  for (const AssembledModel model : models) {
    const auto jam = solved(model, W, {-g_h, -1, 0}, 1.6);
    EXPECT_NEAR(jam[0], 0.3083385, 1e-7);
    EXPECT_NEAR(jam[1], 0.402943, 1e-7);
  }
  const auto slide = solved(AssembledModel::exact, W, {-g_h, 1, 0}, 1.6);
  EXPECT_NEAR(slide[0], 0.00278693, 1e-8);
  EXPECT_NEAR(slide[1], -0.00445909, 1e-8);
  const auto lifted = solved(AssembledModel::convex, W, {-g_h, 1, 0}, 1.6);
  EXPECT_NEAR(lifted[0], 0.1138158, 1e-7);
  EXPECT_NEAR(lifted[1], -0.1821052, 1e-7);
}

TEST(OneContact, RandomBlocksAreSolvedToRounding) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  for (int k = 0; k < 20000; ++k) {
    double h[9];
    for (double& x : h) x = normal(generator);
    const double extra = std::pow(10.0, -6 * uniform(generator));
    Block3 W{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int l = 0; l < 3; ++l)
          W[3 * i + j] += h[3 * i + l] * h[3 * j + l] + (i == j ? extra : 0);
    if (k % 4 == 0) W = {W[0], 0, 0, 0, W[4], 0, 0, 0, W[4]};  // a sphere
    std::array<double, 3> q{normal(generator), normal(generator), normal(generator)};
    if (k % 5 == 0) q[0] = 0;  // only slides: where the multiplier of the convex law meets its pole
    const double mu = k % 7 == 0 ? 0 : std::abs(normal(generator));
    for (const AssembledModel model : models) {
      const auto r = solved(model, W, q, mu);
      const AssembledResidual residual = measure(one_contact(W, q, mu), model, {r[0], r[1], r[2]});
      ASSERT_LE(residual.unit_free, 1e-9) << "block " << k << ", convex or exact";
    }
  }
}

/// Sweeps come with the impulses of the last visit: from guesses near and far the solution
/// is that from none.
TEST(OneContact, GuessesDoNotChangeTheSolution) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  int slipping = 0;
  for (int k = 0; k < 20000; ++k) {
    double h[9];
    for (double& x : h) x = normal(generator);
    Block3 W{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int l = 0; l < 3; ++l)
          W[3 * i + j] += 0.2 * h[3 * i + l] * h[3 * j + l] + (i == j ? 1.0 / 3 : 0);
    if (k % 4 == 0) W = {1, 0, 0, 0, 3.5, 0, 0, 0, 3.5};
    const std::array<double, 3> q{-std::abs(normal(generator)), normal(generator),
                                  normal(generator)};
    const double mu = 0.1 + 0.4 * uniform(generator);
    for (const AssembledModel model : models) {
      const std::array<double, 3> plain = solved(model, W, q, mu, {0, 0, 0});
      const double size = std::hypot(plain[0], plain[1], plain[2]);
      const double friction = std::hypot(plain[1], plain[2]);
      slipping += std::abs(friction - mu * plain[0]) < 1e-12 * size;
      for (const double apart : {1e-8, 1e-3, 0.1, 10.0}) {
        std::array<double, 3> guess = plain;
        for (double& x : guess) x += apart * size * normal(generator);
        const std::array<double, 3> r = solved(model, W, q, mu, guess);
        for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(r[i], plain[i], 1e-12 * size) << k;
      }
    }
  }
  EXPECT_GT(slipping, 10000);
}

/// Impulses that stop a sphere and lie on the cone up to rounding, on either side of it. Where the
/// sign of the miss is rounding alone, the root must not be searched elsewhere.
TEST(OneContact, ContactsThatJustBeginToSlipAreSolved) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 20000; ++k) {
    const double mu = 0.1 + 0.4 * std::abs(uniform(random)), angle = 4 * uniform(random);
    const double stiffness = 100 + 50 * uniform(random);
    Block3 W{stiffness, 0, 0, 0, stiffness, 0, 0, 0, stiffness};
    for (double& w : W) w += 1e-16 * stiffness * std::round(uniform(random));
    const double size = mu * (1 + 2e-16 * std::round(4 * uniform(random)));
    const std::array<double, 3> stop{1e-4, 1e-4 * size * std::cos(angle),
                                     1e-4 * size * std::sin(angle)};
    const std::array<double, 3> q{-stiffness * stop[0], -stiffness * stop[1], -stiffness * stop[2]};
    for (const AssembledModel model : models) {
      const auto r = solved(model, W, q, mu);
      for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(r[i], stop[i], 1e-17) << k;
    }
  }
}

TEST(OneContact, UnsymmetricBlocksAndFrictionlessContactsAreSolved) {
  const Block3 W{2, 0.3, -0.1, 0.31, 3, 0.2, -0.11, 0.19, 1.5};
  const auto r = solved(AssembledModel::exact, W, {-1, 4, -2}, 0.6);
  EXPECT_LE(measure(one_contact(W, {-1, 4, -2}, 0.6), AssembledModel::exact, {r[0], r[1], r[2]})
                .unit_free,
            1e-14);
  for (const AssembledModel model : models)
    EXPECT_EQ(solved(model, W, {-1, 4, -2}, 0), (std::array<double, 3>{0.5, 0, 0}));
}

TEST(NewtonRoot, ConvergesFromAGuessOrSaysThatItDoesNot) {
  const auto cube = [](double x) { return ValueAndSlope{x * x * x - 2, 3 * x * x}; };
  double root = 1.5;
  EXPECT_TRUE(newton_root(cube, root));
  EXPECT_NEAR(root, std::cbrt(2.0), 4e-16);
  double far = 1e9;  // needs more steps than a good guess does
  EXPECT_FALSE(newton_root(cube, far));
  double negative = 0.5;
  EXPECT_FALSE(newton_root([](double x) { return ValueAndSlope{x + 1, 1}; }, negative));
  double none = 0.5;
  EXPECT_FALSE(newton_root([](double x) { return ValueAndSlope{x * x + 1, 2 * x}; }, none));
  double flat = 0.5;
  EXPECT_FALSE(newton_root([](double) { return ValueAndSlope{1, 0}; }, flat));
  double not_a_number = 0.5;
  EXPECT_FALSE(newton_root([](double) { return ValueAndSlope{NAN, NAN}; }, not_a_number));
}

TEST(OneContact, ABlockThatNothingMovesIsLeftAlone) {
  EXPECT_EQ(solved(AssembledModel::exact, Block3{}, {-1, 0, 0}, 0.5),
            (std::array<double, 3>{7, 8, 9}));
}

TEST(AssembledMeasures, AreTheCollectionsErrorAndOneWithoutUnits) {
  // r = 0 and u = q = (-3, 0, 4): the De Saxce velocity is (-3 + 0.5 * 4, 0, 4).
  const AssembledProblem p = one_contact(block(1), {-3, 0, 4}, 0.5);
  // P(-v) of v = (-1, 0, 4): n = (1 + 0.5 * 4) / 1.25 = 2.4, t = 1.2.
  const AssembledResidual exact = measure(p, AssembledModel::exact, {0, 0, 0});
  EXPECT_NEAR(exact.absolute, std::hypot(2.4, 1.2), 1e-14);
  EXPECT_NEAR(exact.relative, std::hypot(2.4, 1.2) / 5, 1e-14);
  EXPECT_NEAR(exact.to_largest, exact.relative, 1e-14);
  EXPECT_NEAR(exact.objective, 0, 0);
  // P(-q): n = (3 + 2) / 1.25 = 4, t = 2.
  EXPECT_NEAR(measure(p, AssembledModel::convex, {0, 0, 0}).absolute, std::hypot(4, 2), 1e-14);
}

TEST(AssembledMeasures, TheUnitFreeOneKeepsItsValueInOtherUnits) {
  const AssembledProblem p = assembled_form(fixtures::random_local_problem(3, 6, false, 2));
  AssembledProblem scaled = p;
  const double mass = 1e4, speed = 10;
  for (Block3& b : scaled.block)
    for (double& x : b) x /= mass;
  for (double& x : scaled.q) x *= speed;
  std::vector<double> r(p.q.size()), scaled_r;
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = std::sin(static_cast<double>(k)) / 100;
  for (const double x : r) scaled_r.push_back(x * mass * speed);
  for (const AssembledModel model : models) {
    const AssembledResidual a = measure(p, model, r), b = measure(scaled, model, scaled_r);
    EXPECT_NEAR(b.unit_free, a.unit_free, 1e-12 * a.unit_free);
    EXPECT_NEAR(b.objective, a.objective * mass * speed * speed, 1e-9 * std::abs(b.objective));
    EXPECT_GT(std::abs(b.relative - a.relative), 0.1 * a.relative);
  }
}

}  // namespace
}  // namespace scree
