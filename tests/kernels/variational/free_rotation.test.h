#pragma once
// Free rotation: against Euler's equations by small steps, closed forms, what is conserved, and when a body with three
// moments flips.

#include <vector>

#include "kernels/variational/free_rotation.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/variational/random_motion.h"

namespace scree {
namespace {

struct FreeBody {
  Vec3d moments, momentum;
  Quatd q;
};

FreeBody random_free_body(std::mt19937& random) {
  FreeBody b;
  b.moments = random_moments(random);
  b.q = random_turn(random);
  b.momentum = rotate(b.q, hadamard(b.moments, normal_vector(random)));
  return b;
}

/// Euler's equations by the classical Runge-Kutta method.
Quatd by_small_steps(const Vec3d& moments, const Vec3d& momentum, double h, const Quatd& q) {
  constexpr int kSteps = 3000;
  const double dt = h / kSteps;
  const auto slope = [&](const Quatd& x) {
    const Vec3d w = rotate(x, rate_of(moments, rotate_back(x, momentum)));
    return Quatd{0, 0.5 * w.x, 0.5 * w.y, 0.5 * w.z} * x;
  };
  const auto plus = [](const Quatd& x, double s, const Quatd& y) {
    return Quatd{x.w + s * y.w, x.x + s * y.x, x.y + s * y.y, x.z + s * y.z};
  };
  Quatd x = q;
  for (int k = 0; k < kSteps; ++k) {
    const Quatd a = slope(x), b = slope(plus(x, dt / 2, a)), c = slope(plus(x, dt / 2, b));
    const Quatd d = slope(plus(x, dt, c));
    x = plus(plus(plus(plus(x, dt / 6, a), dt / 3, b), dt / 3, c), dt / 6, d);
  }
  return normalized(x);
}

double difference(const Quatd& a, const Quatd& b) { return norm(turn_of(conjugate(a) * b)); }

TEST(FreeRotationTest, SolvesEulersEquationsForAnyMoments) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> length(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    FreeBody body = random_free_body(random);
    // Slow enough for small steps.
    const double rate = norm(rate_of(body.moments, rotate_back(body.q, body.momentum)));
    if (rate > 2) body.momentum *= 2 / rate;
    const double h = length(random);
    const Quatd q = turned_freely(body.moments, body.momentum, h, body.q);
    const Quatd expected = by_small_steps(body.moments, body.momentum, h, body.q);
    EXPECT_LT(difference(q, expected), 1e-10) << trial;
  }
}

TEST(FreeRotationTest, PartsOfAStepMakeTheWhole) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> length(0.01, 0.5);
  for (int trial = 0; trial < 500; ++trial) {
    const FreeBody body = random_free_body(random);
    const double h0 = length(random), h1 = length(random);
    const Quatd q = turned_freely(body.moments, body.momentum, h0, body.q);
    const Quatd parts = turned_freely(body.moments, body.momentum, h1, q);
    const Quatd whole = turned_freely(body.moments, body.momentum, h0 + h1, body.q);
    const double size = norm(rate_of(body.moments, rotate_back(body.q, body.momentum)));
    EXPECT_LT(difference(parts, whole), 1e-13 * (1 + size * size)) << trial;
    const Quatd back = turned_freely(body.moments, body.momentum, -h0, q);
    EXPECT_LT(difference(back, body.q), 1e-13 * (1 + size * size)) << trial;
  }
}

TEST(FreeRotationTest, TwoEqualMomentsAreTheLimitOfThree) {
  const Vec3d momentum{0.3, -0.2, 0.5};
  const Quatd start = exp_map(Vec3d{1, 2, 3});
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d moments{0.2, 0.2, 0.2};
    moments[axis] = 0.05;
    Vec3d other = moments;
    other[(axis + 1) % 3] *= 1 + 1e-13;
    ASSERT_EQ(axis_of_symmetry(moments), axis);
    ASSERT_EQ(axis_of_symmetry(other), -1) << "the series is used";
    EXPECT_LT(difference(turned_freely(moments, momentum, 0.7, start),
                         turned_freely(other, momentum, 0.7, start)),
              1e-12);
  }
}

TEST(FreeRotationTest, SteadyRotationsAreThoseOfTheirRate) {
  const Vec3d spin{0.3, -2, 1};
  const Quatd start = exp_map(Vec3d{1, 2, 3});
  const Quatd ball = turned_freely({0.4, 0.4, 0.4}, 0.4 * spin, 0.7, start);
  EXPECT_LT(difference(exp_map(0.7 * spin) * start, ball), 4e-15);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d rate, moments{0.1, 1, 1.05};
    rate[axis] = 3;
    const Quatd q = turned_freely(moments, rotate(start, hadamard(moments, rate)), 0.9, start);
    EXPECT_LT(difference(start * exp_map(0.9 * rate), q), 1e-14) << axis;
  }
}

/// Times at which the second component of the rate changes its sign.
std::vector<double> flips(const Vec3d& rate, double h) {
  const Vec3d moments{1, 2, 3}, momentum = hadamard(moments, rate);
  Quatd q;
  std::vector<double> times;
  double before = rate.y;
  for (int k = 1; h * k <= 100; ++k) {
    q = turned_freely(moments, momentum, h, q);
    const double now = rotate_back(q, momentum).y / moments.y;
    if (before * now < 0) times.push_back(h * (k - now / (now - before)));
    before = now;
  }
  return times;
}

// The times are interpolated between steps, whose length they do not depend on otherwise.
TEST(FreeRotationTest, A50_IntermediateAxisFlips) {
  const std::vector<double> times = flips({0.01, 5, 0.01}, 1e-3);
  ASSERT_GE(times.size(), 19u);
  EXPECT_NEAR(times[0], 2.74107, 1e-5);
  for (std::size_t k = 1; k < times.size(); ++k)
    EXPECT_NEAR(times[k] - times[k - 1], 5.025929, 2e-6) << "flip " << k;
}

TEST(FreeRotationTest, A51_SlowFlips) {
  const std::vector<double> times = flips({0.01, 1, 0}, 1e-3);
  ASSERT_GE(times.size(), 5u);
  EXPECT_NEAR(times[0], 10.37730, 1e-5);
  for (std::size_t k = 1; k < times.size(); ++k)
    EXPECT_NEAR(times[k] - times[k - 1], 20.75461, 1e-5);
}

TEST(FreeRotationTest, EnergyStaysOverAMillionStepsOfAnyLengths) {
  const Vec3d moments{1, 2, 3}, momentum = hadamard(moments, {0.01, 5, 0.01});
  const double energy = spin_energy(moments, momentum);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> length(0.001, 0.02);
  Quatd q;
  double worst = 0;
  for (int k = 0; k < 1000000; ++k) {
    q = turned_freely(moments, momentum, length(random), q);
    worst = std::max(worst, std::abs(spin_energy(moments, rotate_back(q, momentum)) / energy - 1));
  }
  EXPECT_LT(worst, 1e-11);
}

TEST(FreeRotationTest, StepsOfManyTurnsAreSolvedInParts) {
  const Vec3d moments{1, 2, 2.5}, momentum{3, -2, 4};
  Quatd q;
  for (int k = 0; k < 2000; ++k) q = turned_freely(moments, momentum, 0.01, q);
  EXPECT_LT(difference(turned_freely(moments, momentum, 20, {}), q), 1e-11);
}

struct RotateMany {
  static constexpr const char* name = "rotate_many";
  Span<FreeBody> bodies;
  SCREE_HD void operator()(Index i) const {
    FreeBody& b = bodies[i];
    for (int k = 0; k < 10; ++k) b.q = turned_freely(b.moments, b.momentum, 0.05, b.q);
  }
};

class FreeRotationOnBackend : public BackendTest<double> {};

TEST_F(FreeRotationOnBackend, RunsThere) {
  std::mt19937 random(6);
  std::vector<FreeBody> bodies(300);
  for (FreeBody& b : bodies) b = random_free_body(random);
  Buffer<TestBackend, FreeBody> there(backend());
  upload(backend(), bodies, there);
  for_each(backend(), 300, RotateMany{there.view()});
  const std::vector<FreeBody> found = download(backend(), there.view());
  const RotateMany here{{bodies.data(), 300}};
  for (Index i = 0; i < 300; ++i) {
    here(i);
    EXPECT_LT(difference(bodies[i].q, found[i].q), 1e-12) << i;
  }
}

}  // namespace
}  // namespace scree
