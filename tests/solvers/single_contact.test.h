// One-contact problems with closed forms (cases A30 to A33, A45, A46).
#include <cmath>
#include <string>
#include <vector>

#include "solvers/solver.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"
#include "tests/solvers/exact_friction.h"

namespace scree {
namespace {

using fixtures::PlainProblem;
using fixtures::ProblemBuffers;

constexpr double kGravity = 9.81;

/// One body on a fixed plane below it; impulse and velocity after the step.
struct StepResult {
  Eigen::Vector3d impulse;           ///< on the body [N s]
  Eigen::Vector3d velocity;          ///< [m/s]
  Eigen::Vector3d angular_velocity;  ///< [rad/s]
  SolveStats stats;
};

/// A sphere on a plane with upward normal; spin_factor 0 is a block. v* includes gravity.
PlainProblem body_on_plane(double spin_factor, double mu, double bias,
                           const Eigen::Vector3d& velocity,
                           const Eigen::Vector3d& angular_velocity = Eigen::Vector3d::Zero()) {
  PlainProblem p;
  oracle::Body& body = p.data.bodies[p.add_sphere(1, 1, spin_factor)];
  body.velocity = velocity;
  body.angular_velocity = angular_velocity;
  p.add_fixed();
  p.data.free_count = 1;
  p.add_radial_contact(0, 1, {0, 0, -1}, mu).bias = bias;
  return p;
}

/// Uniform rod of half length 1 and mass 1, its lower tip on the plane, tan(theta) = 2
/// (case A45).
PlainProblem painleve_rod(double mu, double tip_speed, double fall_speed) {
  PlainProblem p;
  p.layout = ContactLayout::general;
  p.data.bodies[p.add_general(1, Eigen::Vector3d(1.0 / 3, 1.0 / 3, 1.0 / 3).asDiagonal())]
      .velocity = {tip_speed, 0, -fall_speed};
  p.add_fixed();
  p.data.free_count = 1;
  oracle::Contact& c = p.add_radial_contact(0, 1, {0, 0, -1}, mu);
  c.arm_a = Eigen::Vector3d(-1, 0, -2) / std::sqrt(5.0);
  return p;
}

template <class Real>
class SingleContactTest : public BackendTest<Real> {
 protected:
  /// Every way to solve that runs on the backend: convex solvers, or the De Saxce fixed
  /// point around each.
  template <class F>
  void for_each_solver(bool exact, F check) {
    for (const std::string& name : solver_names(TestBackend::kIsDevice)) {
      auto solver =
          make_solver<TestBackend, Real>(name, {.max_iterations = 1000, .check_every = 1});
      if (exact)
        solver = std::make_unique<CoulombFixedPoint<TestBackend, Real>>(std::move(solver), 200);
      SCOPED_TRACE(name);
      check(*solver);
    }
  }

  StepResult step(Solver<TestBackend, Real>& solver, const PlainProblem& plain) {
    ProblemBuffers<TestBackend, Real> buffers(this->backend(), plain);
    StepResult r;
    r.stats = solver.solve(this->backend(), buffers.problem(), buffers.gamma(),
                           std::is_same_v<Real, double> ? 1e-12 : 1e-6);
    const Eigen::VectorXd v = buffers.velocities(solver.velocity());
    r.velocity = v.head<3>();
    r.angular_velocity = v.segment<3>(3);
    r.impulse = -buffers.impulses()[0];
    return r;
  }

  /// Of a table value, 1e-5 relative in double.
  static double near(double value) { return BackendTest<Real>::tolerance(1e-5) * std::abs(value); }
};
TYPED_TEST_SUITE(SingleContactTest, Reals);

TYPED_TEST(SingleContactTest, A30FirstStepOfTheRelaxation) {
  const double h = 0.0025;
  this->for_each_solver(false, [&](auto& solver) {
    const StepResult block = this->step(solver, body_on_plane(0, 0.3, 0, {2, 0, -kGravity * h}));
    EXPECT_NEAR(block.velocity.norm(), 1.908605, this->near(1.9));
    EXPECT_NEAR(block.velocity.x(), 1.828112, this->near(1.8));
    EXPECT_NEAR(block.velocity.z(), 0.548434, this->near(0.55));

    const StepResult sphere = this->step(solver, body_on_plane(2.5, 0.2, 0, {2, 0, -kGravity * h}));
    EXPECT_NEAR(sphere.velocity.norm(), 1.956692, this->near(1.96));
    EXPECT_NEAR(sphere.angular_velocity.norm(), 0.1861952, this->near(0.186));

    const double theta = 65 * std::acos(-1.0) / 180;
    const StepResult rest = this->step(solver, body_on_plane(0, 0.2, 0,
                                                             {kGravity * h * std::sin(theta), 0,
                                                              -kGravity * h * std::cos(theta)}));
    EXPECT_NEAR(rest.velocity.norm(), 0.0197629, this->near(0.0198));
  });
}

TYPED_TEST(SingleContactTest, A30FirstStepWithExactCoulomb) {
  const double h = 0.0025;
  this->for_each_solver(true, [&](auto& solver) {
    EXPECT_NEAR(this->step(solver, body_on_plane(0, 0.3, 0, {2, 0, -kGravity * h})).velocity.norm(),
                1.99264, this->near(2));
    EXPECT_NEAR(
        this->step(solver, body_on_plane(2.5, 0.2, 0, {2, 0, -kGravity * h})).velocity.norm(),
        1.99509, this->near(2));
    const double theta = 65 * std::acos(-1.0) / 180;
    const StepResult rest = this->step(solver, body_on_plane(0, 0.2, 0,
                                                             {kGravity * h * std::sin(theta), 0,
                                                              -kGravity * h * std::cos(theta)}));
    EXPECT_NEAR(rest.velocity.norm(), 0.0201543, this->near(0.02));
  });
}

/// Published speeds every 0.01 s of a block that starts sliding at 2 m/s.
TYPED_TEST(SingleContactTest, A30PublishedTransient) {
  const double published[] = {1.90861, 1.88276, 1.86174, 1.84569, 1.83476, 1.82903,
                              1.82855, 1.83333, 1.84333, 1.85846, 1.87859};
  const double h = 0.0025;
  this->for_each_solver(false, [&](auto& solver) {
    double gap = 0;
    Eigen::Vector3d v(2, 0, 0);
    for (int k = 0; k < 41; ++k) {
      v.z() -= kGravity * h;
      v = this->step(solver, body_on_plane(0, 0.3, gap / h, v)).velocity;
      gap += h * v.z();
      if (k % 4 == 0) {
        EXPECT_NEAR(v.norm(), published[k / 4], this->near(2)) << "step " << k;
      }
    }
  });
}

TYPED_TEST(SingleContactTest, A31SteadyGlide) {
  const double mu = 0.3;
  this->for_each_solver(false, [&](auto& solver) {
    double gaps[2];
    for (int halving = 0; halving < 2; ++halving) {
      const double h = halving == 0 ? 0.0025 : 0.00125;
      double gap = h * mu * 2, normal = 0;
      Eigen::Vector3d v(2, 0, 0);
      for (int k = 0; k < static_cast<int>(std::lround(0.3 / h)); ++k) {
        v.z() -= kGravity * h;
        const StepResult r = this->step(solver, body_on_plane(0, mu, gap / h, v));
        v = r.velocity;
        gap += h * v.z();
        normal = r.impulse.z();
      }
      EXPECT_NEAR(gap, h * mu * v.x(), this->tolerance(1e-12, 1e-6));
      EXPECT_NEAR(normal / (kGravity * h), 1, this->tolerance(1e-6, 1e-3));
      EXPECT_NEAR(v.x(), halving == 0 ? 1.117762 : 1.117431, this->near(1.1));
      gaps[halving] = gap;
    }
    EXPECT_NEAR(gaps[0] / gaps[1], 2, 0.05);
  });
}

/// With rolling and spinning cones the contact lifts off at mu |u_t| + rolling
/// |u_roll| + spinning |u_spin|.
TYPED_TEST(SingleContactTest, A32LiftWithRollingAndSpinning) {
  const double h = 0.0025, mu = 0.3, rolling = 0.02, spinning = 0.01, length = 0.5;
  PlainProblem plain = body_on_plane(2.5, mu, 0, {2, 0.3, -kGravity * h}, {0.4, 1.1, 3});
  plain.layout = ContactLayout::rolling;
  plain.data.has_moments = true;
  plain.inertia[0] = plain.data.bodies[0].inv_inertia.inverse();
  oracle::Contact& c = plain.data.contacts[0];
  c.length = length, c.rolling = rolling, c.spinning = spinning;
  const auto lift = [&](const StepResult& r) {
    const Eigen::Vector3d slip = r.velocity + r.angular_velocity.cross(Eigen::Vector3d(0, 0, -1));
    return mu * slip.head<2>().norm() + rolling * length * r.angular_velocity.head<2>().norm() +
           spinning * length * std::abs(r.angular_velocity.z());
  };
  this->for_each_solver(false, [&](auto& solver) {
    const StepResult r = this->step(solver, plain);
    EXPECT_GT(r.velocity.z(), 0.1);
    EXPECT_NEAR(r.velocity.z(), lift(r), this->near(1));
  });
  this->for_each_solver(true, [&](auto& solver) {
    const StepResult r = this->step(solver, plain);
    EXPECT_TRUE(r.stats.converged);
    EXPECT_NEAR(r.velocity.z(), 0, this->tolerance(1e-9, 1e-5));
    EXPECT_NEAR(r.impulse.z(), kGravity * h, this->near(1));
  });
}

TYPED_TEST(SingleContactTest, A33FixedPointRemovesTheLift) {
  const double h = 0.0025, mu = 0.3;
  this->for_each_solver(true, [&](auto& solver) {
    double gap = 0;
    Eigen::Vector3d v(2, 0, 0);
    for (int k = 1; k <= 20; ++k) {
      v.z() -= kGravity * h;
      const StepResult r = this->step(solver, body_on_plane(0, mu, gap / h, v));
      v = r.velocity;
      gap += h * v.z();
      EXPECT_TRUE(r.stats.converged);
      EXPECT_LE(r.stats.residual.exact_rms, this->tolerance(1e-12, 1e-6));
      EXPECT_NEAR(r.impulse.z(), kGravity * h, this->near(1) * h);
      EXPECT_NEAR(v.x(), 2 - k * mu * kGravity * h, this->near(2));
    }
    EXPECT_NEAR(gap, 0, this->tolerance(1e-9, 1e-6));
  });
}

TYPED_TEST(SingleContactTest, A33ResidualDropsAtTheContractionRate) {
  if (std::is_same_v<TypeParam, float>) return;  // four decades of contraction need double
  const double h = 0.0025, mu = 0.3, rate = mu * mu / (1 + mu * mu);  // block: k_t = 1
  this->for_each_solver(true, [&](auto& solver) {
    std::vector<CurvePoint> curve;
    solver.record_curve(&curve);
    this->step(solver, body_on_plane(0, mu, 0, {2, 0, -kGravity * h}));
    ASSERT_GE(curve.size(), 5U);
    for (std::size_t k = 2; k < 5; ++k) {
      EXPECT_NEAR(curve[k].residual_rms / curve[k - 1].residual_rms, rate, 0.03)
          << "outer iteration " << k;
    }
  });
}

TYPED_TEST(SingleContactTest, A45PainleveRodSticks) {
  for (bool exact : {false, true}) {
    this->for_each_solver(exact, [&](auto& solver) {
      const StepResult impact = this->step(solver, painleve_rod(1.6, -1, 0));
      EXPECT_NEAR(impact.impulse.z(), 0.3, this->near(0.3));
      EXPECT_NEAR(impact.impulse.x(), 0.4, this->near(0.4));
      const StepResult gravity = this->step(solver, painleve_rod(1.6, -1, 1e-3 * kGravity));
      EXPECT_NEAR(gravity.impulse.z(), 0.3083385, this->near(0.31));
      EXPECT_NEAR(gravity.impulse.x(), 0.402943, this->near(0.4));
    });
  }
}

TYPED_TEST(SingleContactTest, A46PainleveRodSlidesTheOtherWay) {
  const PlainProblem plain = painleve_rod(1.6, 1, 1e-3 * kGravity);
  this->for_each_solver(false, [&](auto& solver) {
    const StepResult r = this->step(solver, plain);
    EXPECT_NEAR(r.impulse.z(), 0.1138158, this->near(0.11));
    EXPECT_NEAR(r.impulse.x(), -0.1821052, this->near(0.18));
    const Eigen::Vector3d tip = r.velocity + r.angular_velocity.cross(plain.data.contacts[0].arm_a);
    EXPECT_NEAR(tip.z(), 0.390821, this->near(0.39));
    EXPECT_NEAR(tip.x(), 0.244263, this->near(0.24));
  });
  this->for_each_solver(true, [&](auto& solver) {
    const StepResult r = this->step(solver, plain);
    EXPECT_NEAR(r.impulse.z(), 0.00278693, this->tolerance(1e-8, 1e-5));
    EXPECT_NEAR(r.impulse.x(), -0.00445909, this->tolerance(1e-8, 1e-5));
  });
}

}  // namespace
}  // namespace scree
