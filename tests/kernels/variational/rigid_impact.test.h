#pragma once
// Impacts of rigid bodies: closed forms, what is conserved, and the projection against all choices of points.

#include <vector>

#include "kernels/variational/impact_points.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/variational/random_motion.h"

namespace scree {
namespace {

ImpactBody moving(double mass, const Vec3d& moments, const Vec3d& v, const Vec3d& rate = {}) {
  ImpactBody b;
  b.mass = mass;
  b.moments = moments;
  b.momentum = mass * v;
  b.spin = hadamard(moments, rate);
  return b;
}

double energy(const RigidImpact& i, double h) { return i.a.energy(h) + i.b.energy(h); }

TEST(RigidImpactTest, TwoBallsExchangeAlongTheLineOfCenters) {
  RigidImpact i;
  i.a = moving(2, {1, 1, 1}, {3, 1, 0});
  i.b = moving(1, {1, 1, 1}, {-1, 0, 2});
  i.points.add({{1, 0, 0}, {0.5, 0, 0}, {-0.3, 0, 0}});
  const ImpactResult done = i.collide(energy(i, 0), 0, 1);
  EXPECT_EQ(done.outcome, ImpactOutcome::reflected);
  EXPECT_NEAR(done.approach_speed, 4, 1e-15);
  EXPECT_NEAR(i.a.velocity().x, 1.0 / 3, 4e-15);
  EXPECT_NEAR(i.b.velocity().x, 13.0 / 3, 4e-15);
  EXPECT_EQ(i.a.velocity().y, 1);
  EXPECT_EQ(i.b.velocity().z, 2);
  EXPECT_LT(norm(i.a.spin), 1e-15);
}

TEST(RigidImpactTest, TheEndOfARodReboundsWithItsRestitution) {
  const double m = 1, half = 0.5, inertia = m / 12, angle = 0.4;
  for (const double e : {1.0, 0.5, 0.0}) {
    RigidImpact i;
    i.a = moving(m, {inertia, inertia, inertia}, {0.3, 0, -2}, {0, 1, 0});
    const Vec3d arm{half * std::cos(angle), 0, -half * std::sin(angle)};
    i.points.add({{0, 0, -1}, arm, {}});
    const double before = i.opening_speed(i.points.point[0]);
    const ImpactResult done = i.collide(energy(i, 0), 0, e);
    EXPECT_NEAR(i.opening_speed(i.points.point[0]), -e * before, 1e-14);
    EXPECT_NEAR(done.impulse.z, (1 + e) * before / (1 / m + arm.x * arm.x / inertia), 1e-14);
    EXPECT_EQ(i.a.momentum.x, 0.3) << "no friction";
  }
}

TEST(RigidImpactTest, AFlatBoxOnFourCornersTurnsBackWithoutSpin) {
  RigidImpact i;
  i.a = moving(3, {1, 2, 2.5}, {0.5, 0.2, -4});
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) i.points.add({{0, 0, -1}, {x, y, -0.5}, {}});
  i.collide(energy(i, 0), 0, 1);
  EXPECT_LT(norm(i.a.velocity() - Vec3d{0.5, 0.2, 4}), 1e-14);
  EXPECT_LT(norm(i.a.spin), 1e-14);
}

TEST(RigidImpactTest, B07_ABallInACornerOfThreeWallsComesBack) {
  RigidImpact i;
  i.a = moving(1, {1, 1, 1}, {-1, -2, -0.5}, {1, 2, 3});
  i.points.add({{-1, 0, 0}, {-0.1, 0, 0}, {}});
  i.points.add({{0, -1, 0}, {0, -0.1, 0}, {}});
  i.points.add({{0, 0, -1}, {0, 0, -0.1}, {}});
  i.collide(energy(i, 0), 0, 1);
  EXPECT_LT(norm(i.a.velocity() - Vec3d{1, 2, 0.5}), 1e-12);
  EXPECT_LT(norm(i.a.spin - Vec3d{1, 2, 3}), 1e-12);
}

TEST(RigidImpactTest, WhatLeavesIsLeftAlone) {
  RigidImpact i;
  i.a = moving(1, {1, 1, 1}, {0, 0, 1});
  i.points.add({{0, 0, -1}, {0, 0, -0.1}, {}});
  const ImpactResult done = i.collide(energy(i, 0), 0, 1);
  EXPECT_EQ(done.outcome, ImpactOutcome::none);
  EXPECT_EQ(i.a.velocity().z, 1);
}

/// Two random bodies that touch in some points of one plane, as those of faces and edges do.
RigidImpact random_impact(std::mt19937& random, bool has_wall) {
  std::uniform_real_distribution<double> uniform(0, 1);
  RigidImpact i;
  const Vec3d n = normalized(normal_vector(random)), center = 0.5 * n + 0.3 * normal_vector(random);
  for (ImpactBody* b : {&i.a, &i.b}) {
    if (has_wall && b == &i.b) continue;
    b->mass = 0.1 + uniform(random);
    b->moments = (0.2 + uniform(random)) * (Vec3d{0.1, 0.1, 0.1} + random_moments(random));
    b->orientation = random_turn(random);
    b->momentum = b->mass * normal_vector(random);
    b->spin = rotate(b->orientation, hadamard(b->moments, normal_vector(random)));
    b->gravity = {0, 0, -9.81};
  }
  i.a.momentum += 3 * i.a.mass * n;
  const Vec3d u = any_orthogonal(n), v = cross(n, u);
  const int count = 1 + static_cast<int>(random() % 4);
  for (int k = 0; k < count; ++k) {
    const Vec3d arm = 0.4 * n + (uniform(random) - 0.5) * u + (uniform(random) - 0.5) * v;
    i.points.add({n, arm, arm - center});
  }
  return i;
}

TEST(RigidImpactTest, RandomPairsKeepMomentaAndTheDiscreteEnergy) {
  std::mt19937 random(1);
  int met = 0, grazing = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    RigidImpact i = random_impact(random, trial % 4 == 0);
    const RigidImpact before = i;
    const double part = trial % 3 == 0 ? 0 : 0.003, rest = trial % 3 == 0 ? 0 : 0.007;
    const double carried = energy(i, part);
    const ImpactResult done = i.collide(carried, rest, 1);
    if (done.outcome == ImpactOutcome::none) continue;
    if (done.outcome == ImpactOutcome::grazing) {
      EXPECT_LT(done.approach_speed, 0.1) << "the pull of gravity in this step";
      ++grazing;
      continue;
    }
    ++met;
    EXPECT_NEAR(energy(i, rest), carried, 1e-14 * (std::abs(carried) + 10)) << trial;
    // Without parts of steps, energies of states.
    if (rest == 0) {
      EXPECT_NEAR(energy(i, 0), energy(before, 0), 1e-13 * energy(before, 0));
    }
    EXPECT_LT(norm(i.a.momentum - before.a.momentum + done.impulse), 1e-14 * 10);
    if (i.b.mass == 0) continue;
    EXPECT_LT(norm(i.a.momentum + i.b.momentum - before.a.momentum - before.b.momentum), 1e-14);
    // About the center of A: that of B is at the difference of the arms.
    const ImpactPoint& p = i.points.point[0];
    const Vec3d d = p.arm_a - p.arm_b;
    const auto angular = [&](const RigidImpact& of) {
      return of.a.spin + of.b.spin + cross(d, of.b.momentum);
    };
    EXPECT_LT(norm(angular(i) - angular(before)), 1e-14 * 10) << trial;
    double least = 0;
    for (int k = 0; k < i.points.count; ++k) {
      const double u = before.opening_speed(before.points.point[k]);
      if (u < 0) least = std::min(least, i.opening_speed(i.points.point[k]));
    }
    EXPECT_GT(least, -1e-6 * done.approach_speed) << "points that approached do not go on";
  }
  EXPECT_GT(met, 3000);
  EXPECT_LT(grazing, 40);
}

TEST(RigidImpactTest, UnderGravityTheNodeEnergyJumpsAsTheFormulaSays) {
  // m g^2 h^2 (1 - 2 alpha) / 8.
  const double h = 0.01, alpha = 0.3, m = 2, g = 9.81;
  RigidImpact i;
  i.a = moving(m, {1, 1, 1}, {0.5, 0, -3});
  i.a.gravity = {0, 0, -g};
  i.points.add({{0, 0, -1}, {0, 0, -0.1}, {}});
  const double before = 0.5 * m * norm2(i.a.velocity());
  i.collide(energy(i, alpha * h), (1 - alpha) * h, 1);
  EXPECT_NEAR(0.5 * m * norm2(i.a.velocity()) - before, m * g * g * h * h * (1 - 2 * alpha) / 8,
              1e-14);
  EXPECT_EQ(i.a.velocity().x, 0.5);
}

TEST(RigidImpactTest, ATouchTooSlowForTheEnergyEquationReflects) {
  const double h = 0.01;
  RigidImpact i;
  i.a = moving(1, {1, 1, 1}, {1, 0, -0.01});
  i.a.gravity = {0, 0, -9.81};
  i.points.add({{0, 0, -1}, {0, 0, -0.1}, {}});
  // Late in the step: energy is to be given away that the normal speed does not have.
  const ImpactResult done = i.collide(energy(i, 0.95 * h), 0.05 * h, 1);
  EXPECT_EQ(done.outcome, ImpactOutcome::grazing);
  EXPECT_NEAR(i.a.velocity().z, 0.01, 1e-16);
}

TEST(RigidImpactTest, ProjectionsAreThoseOfTheBestChoiceOfPoints) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 2000; ++trial) {
    // W of any rank up to five: more points than that depend on each other.
    variational_parts::ConeProjection cone;
    cone.count = 1 + static_cast<int>(random() % 7);
    const int rank = 1 + static_cast<int>(random() % 5);
    double g[8][5] = {}, state[5];
    for (double& x : state) x = normal(random);
    for (int k = 0; k < cone.count; ++k)
      for (int r = 0; r < rank; ++r) g[k][r] = normal(random);
    for (int i = 0; i < cone.count; ++i) {
      for (int r = 0; r < rank; ++r) cone.u[i] += g[i][r] * state[r];
      for (int j = 0; j < cone.count; ++j)
        for (int r = 0; r < rank; ++r) cone.w[i][j] += g[i][r] * g[j][r];
    }
    cone.solve();
    for (int i = 0; i < cone.count; ++i) {
      double after = cone.u[i];
      for (int j = 0; j < cone.count; ++j) after += cone.w[i][j] * cone.beta[j];
      EXPECT_GE(cone.beta[i], 0) << trial;
      EXPECT_GE(after, -1e-10) << trial;
      EXPECT_NEAR(cone.beta[i] * after, 0, 1e-9 * (1 + cone.beta[i])) << trial;
    }
  }
}

SweptShape brick(const Vec3d& half) {
  SweptShape s;
  s.side.kind = shapes::Box::kind;
  s.side.half_extents = half;
  s.radius = norm(half);
  return s;
}

TEST(ImpactPointsTest, FacesEdgesAndCornersTouchInFourTwoAndOne) {
  const double gap = 1e-7, diagonal = std::sqrt(2.0) * 0.1, quarter = 0.25 * 3.14159265358979323846;
  const auto points = [&](const Quatd& q, double height) {
    const PlaneApproach fall{
        brick({0.1, 0.1, 0.1}), RigidPath::fixed({0, 0, height}, q), {}, {0, 0, 1}};
    return impact_points(fall, 0, fall.nearest(0), 1e-7);
  };
  EXPECT_EQ(points({}, 0.1 + gap).count, 4);
  EXPECT_EQ(points(exp_map(Vec3d{quarter, 0, 0}), diagonal + gap).count, 2);
  const Quatd upright = exp_map(std::acos(1 / std::sqrt(3.0)) * normalized(Vec3d{1, -1, 0}));
  EXPECT_EQ(points(upright, std::sqrt(0.03) + gap).count, 1);

  const ConvexApproach on_box{brick({0.1, 0.1, 0.1}), brick({0.5, 0.5, 0.1}),
                              RigidPath::fixed({0.45, 0, 0.2 + gap}, {}), RigidPath::fixed({}, {})};
  const ImpactPoints face = impact_points(on_box, 0, on_box.nearest(0), 1e-7);
  EXPECT_EQ(face.count, 4);
  for (int k = 0; k < face.count; ++k) {
    EXPECT_LT(norm(face.point[k].normal - Vec3d{0, 0, -1}), 1e-12);
    const Vec3d x = Vec3d{0.45, 0, 0.2 + gap} + face.point[k].arm_a;
    EXPECT_LT(norm(x - face.point[k].arm_b), 1e-15) << "one point for both";
    EXPECT_NEAR(x.z, 0.1 + 0.5 * gap, 1e-12);
    EXPECT_LE(x.x, 0.5 + 1e-12);
  }
}

struct CollideMany {
  static constexpr const char* name = "collide_many";
  Span<RigidImpact> impacts;
  SCREE_HD void operator()(Index k) const {
    RigidImpact& i = impacts[k];
    i.collide(i.a.energy(0.003) + i.b.energy(0.003), 0.007, 0.9);
  }
};

class RigidImpactOnBackend : public BackendTest<double> {};

TEST_F(RigidImpactOnBackend, RunsThere) {
  std::mt19937 random(3);
  std::vector<RigidImpact> impacts;
  for (int k = 0; k < 300; ++k) impacts.push_back(random_impact(random, k % 5 == 0));
  Buffer<TestBackend, RigidImpact> there(backend());
  upload(backend(), impacts, there);
  for_each(backend(), 300, CollideMany{there.view()});
  const std::vector<RigidImpact> found = download(backend(), there.view());
  const CollideMany here{{impacts.data(), 300}};
  for (Index k = 0; k < 300; ++k) {
    here(k);
    EXPECT_LT(norm(found[k].a.momentum - impacts[k].a.momentum), 1e-12) << k;
    EXPECT_LT(norm(found[k].b.spin - impacts[k].b.spin), 1e-12) << k;
  }
}

}  // namespace
}  // namespace scree
