// Impacts of bodies that joints hold, by Poisson's hypothesis: closed forms, dense algebra, bodies of one piece.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <tuple>

#include "host/state_hash.h"
#include "tests/physics/compound_scenes.h"
#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kRestitution = 0.6;

/// So short a step that nothing turns in it.
Scene bouncing_scene(double friction, double time_step = 1e-6, Model model = Model::convex) {
  Scene scene = empty_scene(time_step, friction, model);
  scene.gravity = {};
  scene.materials[0].restitution = kRestitution;
  return scene;
}

/// Floor that a ball of radius 0.1 reaches in the middle of the first step.
void add_floor_below(Scene& scene, double speed, double height = 0) {
  add_plane(scene, {0, 0, 1}, {0, 0, height - 0.1 - 0.5 * scene.stepping.time_step * speed});
}

class JointImpacts : public ::testing::TestWithParam<Precision> {
 protected:
  static double digits() { return GetParam() == Precision::double_precision ? 1e-5 : 1e-4; }
  static BodyStates after_one_step(const Scene& scene) {
    World world = joint_world(scene, GetParam());
    EXPECT_TRUE(world.step().converged);
    return world.states();
  }
};
INSTANTIATE_TEST_SUITE_P(Precisions, JointImpacts,
                         ::testing::Values(Precision::double_precision,
                                           Precision::single_precision),
                         name_of_precision);

TEST_P(JointImpacts, ABallOnAnArmBouncesWithTheArm) {
  for (const JointKind kind : {JointKind::hinge, JointKind::ball}) {
    Scene scene = bouncing_scene(0);
    BodyDescription& bob = add_sphere(scene, {1, 0, 0}, 0.1, 1);
    bob.angular_velocity = {0, 2, 0};
    bob.velocity = {0, 0, -2};
    add_floor_below(scene, 2);
    scene.joints.push_back(joint_of(kind, kWorldBody, 0, {}, {0, 1, 0}));
    const BodyStates s = after_one_step(scene);
    EXPECT_NEAR(s.velocity[0].z, 2 * kRestitution, digits());
    EXPECT_NEAR(s.angular_velocity[0].y, -2 * kRestitution, digits());
  }
}

/// Velocities after an impact without friction, from masses, joints as they hold points and axes, and one contact.
struct DensePendulum {
  Eigen::MatrixXd inverse_mass = Eigen::MatrixXd::Zero(12, 12);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(12);
  std::vector<Eigen::VectorXd> rows;

  /// Row of direction d at arm r of a body.
  static void put(Eigen::VectorXd& row, int body, double sign, const Vec3d& r, const Vec3d& d) {
    const Vec3d turn = cross(r, d);
    for (int axis = 0; axis < 3; ++axis) {
      row[6 * body + axis] += sign * d[axis];
      row[6 * body + 3 + axis] += sign * turn[axis];
    }
  }
  /// Solves J v+ = J v for joints, n v+ = -e n v. @return impulses, that of the contact last
  Eigen::VectorXd bounce(const Eigen::VectorXd& contact, double restitution) {
    Eigen::MatrixXd j(static_cast<Eigen::Index>(rows.size()) + 1, 12);
    for (std::size_t k = 0; k < rows.size(); ++k) j.row(static_cast<Eigen::Index>(k)) = rows[k];
    j.row(j.rows() - 1) = contact;
    Eigen::VectorXd wanted = Eigen::VectorXd::Zero(j.rows());
    wanted[j.rows() - 1] = -(1 + restitution) * contact.dot(v);
    const Eigen::VectorXd impulse =
        (j * inverse_mass * j.transpose()).completeOrthogonalDecomposition().solve(wanted);
    v += inverse_mass * j.transpose() * impulse;
    return impulse;
  }
};

TEST_P(JointImpacts, ADoublePendulumBouncesAsDenseAlgebraSays) {
  constexpr double kMass[] = {2, 0.7};
  const Vec3d place[] = {{1, 0, 0}, {1.8, 0.1, -0.05}}, link{1.4, -0.2, 0.1};
  const Vec3d turning[] = {{0, 1.5, 0}, {0, 4, 0}};
  Scene scene = bouncing_scene(0);
  for (int k = 0; k < 2; ++k)
    add_sphere(scene, place[k], 0.1, kMass[k]).angular_velocity = turning[k];
  scene.bodies[0].inertia = {0.3, 0.2, 0.25};
  scene.bodies[0].velocity = cross(turning[0], place[0]);
  scene.bodies[1].velocity = cross(turning[0], link) + cross(turning[1], place[1] - link);
  const double speed = -scene.bodies[1].velocity.z;
  ASSERT_GT(speed, 1);
  add_floor_below(scene, speed, place[1].z);
  scene.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0}));
  scene.joints.push_back(joint_of(JointKind::ball, 0, 1, link));

  DensePendulum dense;
  for (int k = 0; k < 2; ++k) {
    const BodyDescription& body = scene.bodies[static_cast<std::size_t>(k)];
    for (int axis = 0; axis < 3; ++axis) {
      dense.inverse_mass(6 * k + axis, 6 * k + axis) = 1 / body.mass;
      dense.inverse_mass(6 * k + 3 + axis, 6 * k + 3 + axis) = 1 / body.inertia[axis];
      dense.v[6 * k + axis] = body.velocity[axis];
      dense.v[6 * k + 3 + axis] = body.angular_velocity[axis];
    }
  }
  const Vec3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3d& axis : axes) {  // the pivot
    Eigen::VectorXd row = Eigen::VectorXd::Zero(12);
    DensePendulum::put(row, 0, 1, -place[0], axis);
    dense.rows.push_back(row);
  }
  for (const int turn : {3, 5}) {  // the axis of the hinge
    Eigen::VectorXd row = Eigen::VectorXd::Zero(12);
    row[turn] = 1;
    dense.rows.push_back(row);
  }
  for (const Vec3d& axis : axes) {  // the link
    Eigen::VectorXd row = Eigen::VectorXd::Zero(12);
    DensePendulum::put(row, 1, 1, link - place[1], axis);
    DensePendulum::put(row, 0, -1, link - place[0], axis);
    dense.rows.push_back(row);
  }
  Eigen::VectorXd contact = Eigen::VectorXd::Zero(12);
  DensePendulum::put(contact, 1, 1, {0, 0, -0.1}, {0, 0, 1});
  const Eigen::VectorXd impulse = dense.bounce(contact, kRestitution);

  World world = joint_world(scene, GetParam());
  EXPECT_TRUE(world.step().converged);
  const BodyStates s = world.states();
  for (int k = 0; k < 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(s.velocity[i][axis], dense.v[6 * k + axis], 10 * digits()) << k << axis;
      EXPECT_NEAR(s.angular_velocity[i][axis], dense.v[6 * k + 3 + axis], 50 * digits())
          << k << axis;
    }
  }
  // Joints tell of the impact: forces on the second body, and of the floor.
  const std::vector<JointRecord> joints = world.joints();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(joints[0].force[axis], impulse[axis], 20 * digits()) << axis;
    EXPECT_NEAR(joints[1].force[axis], impulse[5 + axis], 20 * digits()) << axis;
  }
  double pressed = 0;
  for (const ContactRecord& c : world.contacts()) pressed += c.impulse.z;
  EXPECT_NEAR(std::abs(pressed), impulse[8], 20 * digits());
}

class HeldBalls : public ::testing::TestWithParam<std::tuple<Precision, Model>> {};
INSTANTIATE_TEST_SUITE_P(Models, HeldBalls,
                         ::testing::Combine(::testing::Values(Precision::double_precision,
                                                              Precision::single_precision),
                                            ::testing::Values(Model::convex, Model::exact)));

TEST_P(HeldBalls, BounceLikeOneBody) {
  const auto [precision, model] = GetParam();
  const double digits = precision == Precision::double_precision ? 1e-5 : 1e-4;
  const auto after_one_step = [&, at = precision](const Scene& scene) {
    World world = joint_world(scene, at);
    EXPECT_TRUE(world.step().converged);
    return world.states();
  };
  // A bar of two balls, as a body of two parts or as two bodies; it comes askew and turns, so that friction acts.
  const Vec3d half = rotate(exp_map(Vec3d{0.2, 0.6, 0}), Vec3d{0.15, 0, 0});
  const Vec3d velocity{1.5, 0.4, -2}, turning{0.3, -0.8, 0.5};
  Scene two = bouncing_scene(0.4, 1e-6, model);
  for (const double side : {1.0, -1.0}) {
    BodyDescription& ball = add_sphere(two, side * half, 0.1, 0.5);
    ball.velocity = velocity + cross(turning, side * half);
    ball.angular_velocity = turning;
  }
  two.joints.push_back(joint_of(JointKind::fixed, 0, 1, {}));
  const double low = std::min(half.z, -half.z);
  add_plane(two, {0, 0, 1}, {0, 0, low - 0.1 - 1e-6});

  Scene one = bouncing_scene(0.4, 1e-6, model);
  BodyDescription& bar =
      add_compound(one, {}, {part(ball_of(0.1), half), part(ball_of(0.1), -half)});
  bar.inertia = (1 / bar.mass) * bar.inertia;
  bar.mass = 1;
  bar.velocity = velocity;
  bar.angular_velocity = turning;
  add_plane(one, {0, 0, 1}, {0, 0, low - 0.1 - 1e-6});

  const BodyStates a = after_one_step(two), b = after_one_step(one);
  const Vec3d mean = 0.5 * (a.velocity[0] + a.velocity[1]);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(mean[axis], b.velocity[0][axis], 10 * digits) << axis;
    EXPECT_NEAR(a.angular_velocity[0][axis], b.angular_velocity[0][axis], 50 * digits) << axis;
    EXPECT_NEAR(a.angular_velocity[1][axis], b.angular_velocity[0][axis], 50 * digits) << axis;
  }
  EXPECT_GT(mean.z, 0);
}

/// Velocities along z of a ball at rest and of one that comes from above with 1 m/s, as heavy, without friction.
struct Hit {
  double struck, striker;
};
Hit hit(Precision precision, const Joint& joint, double from = 1) {
  Scene scene = bouncing_scene(0);
  const double gap = 0.5e-6;
  add_sphere(scene, {}, 0.1, 1);
  add_sphere(scene, {0, 0, from * (0.2 + gap)}, 0.1, 1).velocity = {0, 0, -from};
  scene.joints.push_back(joint);
  World world = joint_world(scene, precision);
  EXPECT_TRUE(world.step().converged);
  const BodyStates s = world.states();
  return {from * s.velocity[0].z, from * s.velocity[1].z};
}

TEST_P(JointImpacts, WhatHoldsABallIsAWallAndWhatGivesWayIsNot) {
  const auto expect = [&](const Joint& joint, double from, double struck, const char* what) {
    SCOPED_TRACE(what);
    const Hit found = hit(GetParam(), joint, from);
    EXPECT_NEAR(found.struck, struck, digits());
    // Newton's law of restitution, and the momentum where the ball is free.
    EXPECT_NEAR(found.striker - found.struck, kRestitution, digits());
    if (struck != 0) {
      EXPECT_NEAR(found.striker + found.struck, -1, digits());
    }
  };
  const double free = -(1 + kRestitution) / 2;
  expect(joint_of(JointKind::fixed, kWorldBody, 0, {}), 1, 0, "fixed");
  expect(joint_of(JointKind::slider, kWorldBody, 0, {}, {1, 0, 0}), 1, 0, "across a slider");
  const Joint slider = joint_of(JointKind::slider, kWorldBody, 0, {}, {0, 0, 1});
  expect(slider, 1, free, "along a slider");

  const auto cable = [](double length) {
    Joint joint = line_of(JointKind::cable, kWorldBody, 0, {0, 0, 1}, {});
    joint.length = length;
    return joint;
  };
  expect(cable(1), 1, 0, "a taut cable, pulled");
  expect(cable(1), -1, free, "a taut cable, let go");
  expect(cable(1.1), 1, free, "a loose cable");

  Joint limited = slider;
  limited.limits = {0, 0.5};
  expect(limited, 1, 0, "against a limit");
  expect(limited, -1, free, "off a limit");

  Joint spring = line_of(JointKind::spring, kWorldBody, 0, {0, 0, 1}, {});
  spring.length = 1;
  spring.stiffness = 100;
  spring.damping = 1;
  expect(spring, 1, free, "a spring");

  Joint driven = slider;
  driven.motor = JointMotor{};
  expect(driven, 1, 0, "a motor of any force");
  driven.motor->max_force = 5;
  expect(driven, 1, free, "a motor of 5 N");

  Joint rubbing = slider;
  rubbing.friction = 5;
  expect(rubbing, 1, free, "friction");
}

TEST_P(JointImpacts, JointsBreakOfThem) {
  for (const bool is_weak : {false, true}) {
    Scene scene = bouncing_scene(0, 1e-3);
    add_sphere(scene, {}, 0.1, 1);
    add_sphere(scene, {0, 0, 0.2005}, 0.1, 1).velocity = {0, 0, -1};
    Joint joint = joint_of(JointKind::fixed, kWorldBody, 0, {});
    joint.break_force = is_weak ? 1500 : 1700;  // 1.6 N s in 1 ms
    scene.joints.push_back(joint);
    World world = joint_world(scene, GetParam());
    world.step();
    EXPECT_NEAR(norm(world.joints()[0].force), 1.6, 20 * digits());
    EXPECT_EQ(world.joints()[0].is_broken, is_weak);
    world.step();
    EXPECT_NEAR(norm(world.joints()[0].force), 0, 20 * digits());
  }
}

/// Chains of four balls each on ball joints, in a closed box without gravity.
Scene gas_of_chains(double restitution, double friction) {
  Scene scene = empty_scene(5e-4, friction);
  scene.gravity = {};
  scene.materials[0].restitution = restitution;
  solve_to(scene, 1e-8);
  for (int chain = 0; chain < 8; ++chain)
    for (int k = 0; k < 4; ++k) {
      const Vec3d at{0.05 + 0.11 * k, 0.1 + 0.2 * (chain % 4), 0.15 + 0.2 * (chain / 4)};
      BodyDescription& ball = add_sphere(scene, at, 0.05, 0.3 + 0.1 * k);
      ball.velocity = {0.5 - 0.3 * chain + (k % 2), 0.8 - 0.4 * k, chain % 2 - 0.5};
      ball.angular_velocity = {1.0 * k, 0.5 * chain, 2.0 - k};
      if (k > 0)
        scene.joints.push_back(
            joint_of(JointKind::ball, 4 * chain + k - 1, 4 * chain + k, at - Vec3d{0.055, 0, 0}));
    }
  for (const auto& [normal, point] :
       std::vector<std::pair<Vec3d, Vec3d>>{{{0, 0, 1}, {}},
                                            {{0, 0, -1}, {0, 0, 0.5}},
                                            {{1, 0, 0}, {-0.05, 0, 0}},
                                            {{-1, 0, 0}, {0.5, 0, 0}},
                                            {{0, 1, 0}, {}},
                                            {{0, -1, 0}, {0, 0.8, 0}}})
    add_plane(scene, normal, point);
  return scene;
}

double kinetic_energy(const Scene& scene, const BodyStates& s) {
  double sum = 0;
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    const BodyDescription& body = scene.bodies[i];
    if (body.kind != BodyKind::free) continue;
    sum += 0.5 * body.mass * norm2(s.velocity[i]) +
           0.5 * body.inertia.x * norm2(s.angular_velocity[i]);
  }
  return sum;
}

TEST(JointImpactsOfChains, NeitherAddEnergyNorLoseMoreThanTheyShould) {
  for (const double restitution : {1.0, 0.5}) {
    const Scene scene = gas_of_chains(restitution, restitution == 1 ? 0 : 0.5);
    World world = reference_world(scene);
    double first = 0, before = 0, most = 0;
    int impacts = 0;
    for (int k = 0; k < 1000; ++k) {
      EXPECT_TRUE(world.step().converged) << k;
      const double energy = kinetic_energy(scene, world.states());
      if (k == 0) first = before = energy;  // joints hold from here on
      most = std::max(most, energy / before - 1);
      impacts += energy < 0.99 * before ? 1 : 0;
      before = energy;
    }
    EXPECT_LT(most, 5e-3) << restitution;
    if (restitution == 1) {
      EXPECT_NEAR(before / first, 1, 0.02);
    } else {
      EXPECT_LT(before / first, 0.4);
      EXPECT_GT(impacts, 20);
    }
  }
}

TEST(JointImpactsOfChains, HaveTheSameBitsAfterARestart) {
  const Scene scene = gas_of_chains(0.7, 0.3);
  World whole = reference_world(scene), half = reference_world(scene);
  for (int k = 0; k < 400; ++k) whole.step();
  bool was_seen = false;
  for (int k = 0; k < 400; ++k) {
    half.step();
    if (was_seen || k < 150) continue;
    // In the middle of a step with an impact, what joints carry is kept too.
    double largest = 0;
    for (const JointRecord& joint : half.joints()) largest = std::max(largest, norm(joint.force));
    if (!(largest > 0.1)) continue;
    World next = reference_world(scene);
    next.restore(half.save());
    for (std::size_t j = 0; j < scene.joints.size(); ++j)
      EXPECT_EQ(next.joints()[j].force.x, half.joints()[j].force.x);
    half = std::move(next);
    was_seen = true;
  }
  EXPECT_TRUE(was_seen);
  EXPECT_EQ(state_hash(whole.states()), state_hash(half.states()));
}

}  // namespace
}  // namespace scree::physics
