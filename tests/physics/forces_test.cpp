// Forces on walls, groups and joints: weights, friction, and the balance of momentum and of its
// moment, impacts and rolling friction included.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/error.h"
#include "tests/box_mesh.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

MeanForces forces_over(World& world, int steps) {
  for (int k = 0; k < steps; ++k) world.step();
  return world.take_forces();
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance, const char* what) {
  EXPECT_NEAR(a.x, b.x, tolerance) << what;
  EXPECT_NEAR(a.y, b.y, tolerance) << what;
  EXPECT_NEAR(a.z, b.z, tolerance) << what;
}

TEST(Forces, ASphereAtRestLoadsItsFloorByItsWeight) {
  Scene scene = empty_scene(1e-3, 0.5);
  add_plane(scene);
  add_sphere(scene, {0.3, 0.2, 0.01}, 0.01, 2);
  World world = reference_world(scene);
  EXPECT_THROW(world.take_forces(), InputError);
  world.track_forces();
  const MeanForces forces = forces_over(world, 5);
  EXPECT_EQ(forces.steps, 5);
  ASSERT_EQ(forces.bodies, std::vector<int>{0});
  ASSERT_EQ(forces.on_bodies.size(), 1u);
  const double weight = 2 * kGravity;
  expect_near(forces.on_bodies[0].force, {0, 0, -weight}, 1e-9 * weight, "force");
  // r x F about the plane's position, the origin
  expect_near(forces.on_bodies[0].torque, {-0.2 * weight, 0.3 * weight, 0}, 1e-9, "torque");
  EXPECT_EQ(world.take_forces().steps, 0);
}

TEST(Forces, ASlidingSphereDragsItsFloor) {
  Scene scene = empty_scene(1e-3, 0.2, Model::exact);
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.01}, 0.01, 2).velocity = {3, 0, 0};
  World world = reference_world(scene);
  world.track_forces();
  world.step();  // lands
  world.take_forces();
  const Vec3d force = forces_over(world, 10).on_bodies[0].force;
  EXPECT_NEAR(force.x / -force.z, 0.2, 1e-9);
}

/// A lid on four grains in a box of walls: each group carries what stands on it.
TEST(Forces, GroupsPushEachOther) {
  Scene scene = empty_scene(1e-3, 0.3);
  scene.groups = {"walls", "grains", "lid"};
  add_plane(scene);
  for (const double x : {-0.05, 0.05})
    for (const double y : {-0.05, 0.05}) add_sphere(scene, {x, y, 0.01}, 0.01, 0.1).group = 1;
  add_box(scene, {0, 0, 0.025}, {0.1, 0.1, 0.005}, 3).group = 2;
  World world = reference_world(scene);
  for (int k = 0; k < 50; ++k) world.step();
  world.track_forces();
  const MeanForces forces = forces_over(world, 10);
  ASSERT_EQ(forces.on_groups.size(), 3u);
  const double lid = 3 * kGravity, grains = 4 * 0.1 * kGravity;
  expect_near(forces.on_groups[2].force, {0, 0, lid}, 1e-6, "lid");
  expect_near(forces.on_groups[1].force, {0, 0, grains}, 1e-6, "grains");
  expect_near(forces.on_groups[0].force, {0, 0, -lid - grains}, 1e-6, "walls");
  expect_near(forces.on_bodies[0].force, forces.on_groups[0].force, 1e-9, "floor");
}

/// A ball that lies on a wall's end across the border of a periodic domain, and what the wall then feels.
ForceRecord on_wall_across(const std::function<void(Scene&)>& add_wall, const Vec3d& ball) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.gravity = {-10, -2, 0};
  scene.periodicity.periodic = {true, false, false};
  scene.periodicity.lower = {-1, 0, 0};
  scene.periodicity.upper = {1, 0, 0};
  add_wall(scene);
  add_sphere(scene, ball, 0.1, 1);
  World world = reference_world(scene);
  world.track_forces();
  const MeanForces forces = forces_over(world, 1);
  return forces.on_bodies.at(0);
}

// The arm goes to the image of the wall that is touched, not to the one on the far side of the domain.
TEST(Forces, MomentsOnWallsAreThoseOfTheirImages) {
  // A sphere that begins to roll along the face: 2/7 of the force along it is friction.
  const double along = -2.0 * 2 / 7;
  const auto box = [](Scene& s) { add_wall_box(s, {0.95, 0, 0}, {0.1, 0.1, 0.1}); };
  const ForceRecord on_box = on_wall_across(box, {-0.85, 0.05, 0});
  expect_near(on_box.force, {-10, along, 0}, 1e-6, "force on the box");
  expect_near(on_box.torque, {0, 0, 0.1 * along - 0.05 * -10}, 1e-6, "moment on the box");
  const auto mesh = [](Scene& s) {
    add_mesh(s, test::box_mesh({0.1, 0.1, 0.1})).position = {0.95, 0, 0};
  };
  const ForceRecord on_mesh = on_wall_across(mesh, {-0.85, 0.05, 0});
  expect_near(on_mesh.torque, {0, 0, 0.1 * along - 0.05 * -10}, 1e-6, "moment on the mesh");
  const auto sphere = [](Scene& s) {
    BodyDescription& wall = add_sphere(s, {0.95, 0, 0}, 0.1, 1);
    wall.kind = BodyKind::fixed;
  };
  const ForceRecord on_sphere = on_wall_across(sphere, {-0.85, 0, 0});
  expect_near(on_sphere.torque, {0, 0, 0.1 * along}, 1e-6, "moment on the sphere");
}

// The lever along the axis of an endless wall would be that of any of its images.
TEST(Forces, EndlessWallsHaveNoLeverAlongTheirAxis) {
  const auto bar = [](Scene& s) {
    s.gravity = {0, 0, -10};
    add_wall_box(s, {}, {1, 0.1, 0.1});
  };
  const ForceRecord on_bar = on_wall_across(bar, {0.5, 0.04, 0.2});
  expect_near(on_bar.force, {0, 0, -10}, 1e-6, "force");
  expect_near(on_bar.torque, {-0.4, 0, 0}, 1e-6, "moment");
}

TEST(Forces, AHingeCarriesThePendulumThatHangsOnIt) {
  Scene scene = empty_scene(1e-3, 0.3);
  add_sphere(scene, {0, 0, -0.5}, 0.05, 2);
  Joint joint;
  joint.bodies = {kWorldBody, 0};
  scene.joints.push_back(joint);
  World world = reference_world(scene);
  world.track_forces();
  const MeanForces forces = forces_over(world, 20);
  ASSERT_EQ(forces.on_joints.size(), 1u);
  expect_near(forces.on_joints[0].force, {0, 0, 2 * kGravity}, 1e-6, "at the anchor");
}

struct Momentum {
  Vec3d linear, angular;  ///< about the origin
};

/// Of free spheres, from what a World shows.
Momentum momentum_of(const Scene& scene, const World& world) {
  const BodyStates s = world.states();
  Momentum sum;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const BodyDescription& body = scene.bodies[i];
    if (body.kind != BodyKind::free) continue;
    sum.linear += body.mass * s.velocity[i];
    sum.angular +=
        body.mass * cross(s.position[i], s.velocity[i]) + body.inertia.x * s.angular_velocity[i];
  }
  return sum;
}

/// What the walls gave and what the bodies got are the same, whatever happened in between.
class ForceBalance : public testing::TestWithParam<RestitutionLaw> {};

TEST_P(ForceBalance, WallsGiveWhatTheBodiesGet) {
  for (const double rolling : {0.0, 1e-3}) {
    Scene scene = empty_scene(1e-3, 0.4);
    scene.gravity = {1, -2, -9};
    scene.stepping.restitution_law = GetParam();
    scene.materials[0].restitution = 0.6;
    scene.materials[0].rolling_friction = rolling;
    scene.materials[0].spinning_friction = rolling;
    solve_to(scene, 1e-9);
    add_plane(scene);
    add_plane(scene, {0, 1, 0}, {0, -0.2, 0});
    add_plane(scene, {-1, 0, 0}, {0.2, 0, 0});
    BodyDescription& paddle =
        add_wall_box(scene, {0, 0, 0.05}, {0.1, 0.02, 0.05}, BodyKind::kinematic);
    Motion motion;
    motion.kind = Motion::Kind::rotating;
    motion.axis = {0, 0, 1};
    motion.center = {0.03, 0, 0};
    motion.rate = 5;
    paddle.motion = motion;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-0.15, 0.15), speed(-1, 1);
    for (int k = 0; k < 40; ++k) {
      BodyDescription& ball = add_sphere(
          scene, {0.04 * (k % 7) - 0.12, 0.04 * (k / 7 % 7) - 0.12, 0.13 + 0.04 * (k % 3)}, 0.015,
          0.02);
      ball.velocity = {speed(random), speed(random), speed(random) - 2};
      ball.angular_velocity = {9 * speed(random), 9 * speed(random), 9 * speed(random)};
    }
    World world = reference_world(scene);
    world.track_forces();
    const double h = scene.stepping.time_step, mass = 40 * 0.02;
    double largest = 0, tightest = 1;
    for (int k = 0; k < 150; ++k) {
      const BodyStates start = world.states();
      const Momentum before = momentum_of(scene, world);
      const StepReport report = world.step();
      ASSERT_TRUE(report.converged) << "step " << k;
      const Momentum after = momentum_of(scene, world);
      const MeanForces forces = world.take_forces();
      Vec3d force = mass * scene.gravity, torque;
      for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (scene.bodies[i].kind == BodyKind::free)
          torque += cross(start.position[i], scene.bodies[i].mass * scene.gravity);
      for (std::size_t w = 0; w < forces.bodies.size(); ++w) {
        const auto id = static_cast<std::size_t>(forces.bodies[w]);
        const ForceRecord& on_wall = forces.on_bodies[w];
        force -= on_wall.force;
        torque -= on_wall.torque + cross(start.position[id], on_wall.force);
        largest = std::max(largest, norm(on_wall.force));
      }
      // The tangential part of a force acts at either end of the gap, of fast bodies where they pass.
      double across_gaps = 1e-7;
      for (const ContactRecord& contact : world.contacts()) {
        const auto a = static_cast<std::size_t>(contact.body_a);
        const auto b = static_cast<std::size_t>(contact.body_b);
        const double way = h * norm(start.velocity[b] - start.velocity[a]);
        across_gaps += (std::abs(contact.gap) + way) * norm(contact.impulse) / h;
      }
      expect_near((1 / h) * (after.linear - before.linear), force, 1e-8, "force");
      expect_near((1 / h) * (after.angular - before.angular), torque, across_gaps, "torque");
      tightest = std::min(tightest, across_gaps / norm(torque));
    }
    EXPECT_GT(largest, 5 * mass * 9) << "nothing hit a wall";
    EXPECT_LT(tightest, 1e-3) << "the tolerance says nothing";
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ForceBalance,
                         testing::Values(RestitutionLaw::poisson, RestitutionLaw::newton));

}  // namespace
}  // namespace scree::physics
