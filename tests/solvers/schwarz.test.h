// Accelerated Schwarz: passes as the backend runs them against plain ones, and whole solves.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "solvers/schwarz.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"

namespace scree {
namespace {

using fixtures::lattice_problem;
using fixtures::linear;
using fixtures::PlainProblem;
using fixtures::ProblemBuffers;
using fixtures::relative_distance;

/// A lattice of spheres with disordered contacts that falls on a floor.
PlainProblem falling_lattice(int n, double share) {
  PlainProblem plain = lattice_problem(n, share, 7);
  std::mt19937 generator(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const auto vector = [&] {
    return Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
  };
  const int floor = plain.add_fixed();
  for (int i = 0; i < plain.data.free_count; ++i) {
    oracle::Body& body = plain.data.bodies[i];
    body.velocity = Eigen::Vector3d(0, 0, -1) + 0.3 * vector();
    body.angular_velocity = 0.3 * vector();
    if (i % 5 == 0) plain.add_radial_contact(i, floor, {0, 0, -1}, 0.5);
  }
  for (oracle::Contact& c : plain.data.contacts) {
    c.normal = (c.normal + 0.2 * vector()).normalized();
    c.arm_a = plain.radius[c.a] * c.normal;
    c.arm_b = -plain.radius[c.b] * c.normal;
    c.bias = 0.2 * unit(generator);  // rest is feasible
  }
  std::stable_sort(plain.data.contacts.begin(), plain.data.contacts.end(),
                   [](const auto& x, const auto& y) { return x.a < y.a; });
  return plain;
}

/// The problem with one friction coefficient for all.
template <class Real>
ContactProblem<Real> with_uniform_friction(ContactProblem<Real> p) {
  p.friction = {};
  p.friction.uniform = Real(0.5);
  return p;
}

/// Passes of one solve from zero impulses.
template <class Real>
class Run {
 public:
  using R = RadialRows<Real>;

  Run(TestBackend& b, const ContactProblem<Real>& p)
      : b_(b), tiles_(b), state_(b, 1), passes_{p, {}, {}, state_.data(), 1, 2} {
    for (int k = 0; k < 2; ++k) {
      impulses_.emplace_back(b, p.contact_count);
      twists_.emplace_back(b, p.bodies.count);
      passes_.gamma[k] = impulses_[k].view();
      passes_.velocity[k] = twists_[k].view();
      fill(b, passes_.gamma[k], Vec3<Real>{});
      for_each(b, p.bodies.count, StartVelocity<Real>{p, passes_.velocity[k]});
    }
    fill(b, state_.view(), SchwarzState{});
    tiles_.compute(b, p, 48);
  }

  /// Passes in blocks of several sizes, 14 in all.
  template <class Iteration>
  void run() {
    Iteration iteration(b_);
    iteration.start(b_, passes_, tiles_);
    for (const int count : {1, 8, 5}) {
      for_blocks(iteration, count);
      done_ += count;
    }
  }

  std::vector<Vec3<Real>> impulses() { return download(b_, passes_.impulses(done_).current); }
  std::vector<Vec3<Real>> velocities() {
    return linear(download(b_, passes_.velocities(done_).current));
  }
  SchwarzState state() { return fetch(b_, state_.data()); }

 private:
  void for_blocks(SchwarzIteration<TestBackend, R, Real>& iteration, int count) {
    iteration.run(b_, passes_, tiles_, done_, count);
  }
  void for_blocks(PlainSchwarz<TestBackend, R, Real>& iteration, int count) {
    for (int k = 0; k < count; ++k) iteration.run(b_, passes_, tiles_, done_ + k);
  }

  TestBackend& b_;
  TileColoring<TestBackend> tiles_;
  Buffer<TestBackend, SchwarzState> state_;
  std::vector<Buffer<TestBackend, Vec3<Real>>> impulses_;
  std::vector<Buffer<TestBackend, Twist<Real>>> twists_;
  SchwarzPasses<R, Real> passes_;
  int done_ = 0;
};

template <class Real>
class SchwarzTest : public BackendTest<Real> {
 protected:
  void expect_match(const ContactProblem<Real>& p) {
    using R = RadialRows<Real>;
    Run<Real> plain(this->backend(), p), tuned(this->backend(), p), again(this->backend(), p);
    plain.template run<PlainSchwarz<TestBackend, R, Real>>();
    tuned.template run<SchwarzIteration<TestBackend, R, Real>>();
    again.template run<SchwarzIteration<TestBackend, R, Real>>();
    const double tolerance = this->tolerance(1e-13, 3e-5);
    EXPECT_LE(relative_distance(plain.impulses(), tuned.impulses()), tolerance);
    EXPECT_LE(relative_distance(plain.velocities(), tuned.velocities()), tolerance);
    EXPECT_EQ(plain.state().restarts, tuned.state().restarts);
    EXPECT_DOUBLE_EQ(plain.state().theta, tuned.state().theta);
    EXPECT_EQ(tuned.impulses(), again.impulses());
    EXPECT_EQ(tuned.velocities(), again.velocities());
  }
};
TYPED_TEST_SUITE(SchwarzTest, Reals);

TYPED_TEST(SchwarzTest, MatchesThePlainPasses) {
  ProblemBuffers<TestBackend, TypeParam> buffers(this->backend(), falling_lattice(9, 0.5));
  this->expect_match(with_uniform_friction(buffers.problem()));
}

/// More tiles than a device works on at a time.
TYPED_TEST(SchwarzTest, MatchesOverManyTiles) {
  if (!TestBackend::kIsDevice) GTEST_SKIP() << "the CPU has no tuned twin";
  ProblemBuffers<TestBackend, TypeParam> buffers(this->backend(), falling_lattice(40, 0.5));
  this->expect_match(with_uniform_friction(buffers.problem()));
}

/// Tiles that do not fit into fast memory, or have no links; friction and adhesion of each contact.
TYPED_TEST(SchwarzTest, MatchesWithManyContactsABody) {
  for (const int contacts : {300, 2500}) {
    const PlainProblem plain = fixtures::random_problem({.free_count = 150,
                                                         .fixed_count = 3,
                                                         .contact_count = contacts,
                                                         .seed = 4,
                                                         .has_adhesion = true});
    ProblemBuffers<TestBackend, TypeParam> buffers(this->backend(), plain);
    this->expect_match(buffers.problem());
  }
}

TYPED_TEST(SchwarzTest, SolvesAsApgdInFewerPasses) {
  const PlainProblem plain = falling_lattice(8, 0.6);
  ProblemBuffers<TestBackend, TypeParam> buffers(this->backend(), plain);
  const ContactProblem<TypeParam> p = with_uniform_friction(buffers.problem());
  const double tolerance = std::is_same_v<TypeParam, double> ? 1e-8 : 1e-4;
  const auto solve = [&](const char* name) {
    buffers.clear_impulses();
    const auto solver = make_solver<TestBackend, TypeParam>(name, {.max_iterations = 5000});
    const SolveStats stats = solver->solve(this->backend(), p, buffers.gamma(), tolerance);
    EXPECT_TRUE(stats.converged) << name << ": residual " << stats.residual.rms;
    return stats;
  };
  const SolveStats apgd = solve("apgd"), schwarz = solve("schwarz");
  EXPECT_NEAR(schwarz.residual.objective, apgd.residual.objective,
              this->tolerance(1e-10, 1e-5) * std::abs(apgd.residual.objective));
  EXPECT_LT(2 * schwarz.applications, apgd.applications);
  EXPECT_GT(schwarz.colors, 1);
}

/// Momentum of pass k + 2 after pass k.
TEST(SchwarzMomentum, GrowsAndRestarts) {
  SchwarzState s;
  EXPECT_EQ(s.beta_of(0), 0);
  EXPECT_GT(s.beta_of(1), 0.6);
  const double first = s.beta_of(1), theta = s.theta;
  SchwarzFinish{&s, 0}({{-1.0}});
  EXPECT_GT(s.beta_of(2), first);
  EXPECT_LT(s.theta, theta);
  SchwarzFinish{&s, 1}({{1.0}});  // pass 1 went uphill: pass 3 has no momentum
  EXPECT_EQ(s.beta_of(3), 0);
  EXPECT_GT(s.beta_of(2), 0);
  EXPECT_EQ(s.theta, 1);
  EXPECT_EQ(s.restarts, 1);
  SchwarzFinish{&s, 2}({{1.0}});  // pass 2 had the old one: no second restart
  EXPECT_EQ(s.restarts, 1);
  EXPECT_EQ(s.beta_of(4), 0);  // that of theta = 1
  SchwarzRestart{&s, true}(0);
  SchwarzFinish{&s, 3}({{-1.0}});
  SchwarzFinish{&s, 4}({{-1.0}});
  EXPECT_EQ(s.beta_of(5), 0);
  EXPECT_EQ(s.beta_of(6), 0);
}

}  // namespace
}  // namespace scree
