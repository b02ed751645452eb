// What the variational model does not have is refused by name, and what it cannot go on with ends the run by name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "host/error.h"
#include "shapes/compound.h"
#include "tests/dynamics/variational_scenes.h"

namespace scree::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Scene two_spheres() {
  Scene scene = variational_scene(0.01);
  add_sphere(scene, {0, 0, 1}, 0.25, 1);
  add_sphere(scene, {2, 0, 1}, 0.25, 1);
  return scene;
}

std::string refusal(const std::function<void(Scene&)>& change) {
  Scene scene = two_spheres();
  change(scene);
  try {
    validate(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(VariationalRefusals, TakesConvexBodiesAndFixedWalls) {
  EXPECT_EQ(refusal([](Scene& s) {
              physics::add_box(s, {0, 0, 3}, {0.1, 0.1, 0.1}, 1);
            }),
            "nothing");
  EXPECT_EQ(refusal([](Scene& s) { physics::add_plane(s); }), "nothing");
  EXPECT_EQ(refusal([](Scene& s) { physics::add_valley(s); }), "nothing");
  EXPECT_EQ(refusal([](Scene& s) {
              physics::add_wall_box(s, {0, 0, -1}, {1, 1, 0.1});
            }),
            "nothing");
}

TEST(VariationalRefusals, WhatItDoesNotHaveIsNamed) {
  EXPECT_THAT(refusal([](Scene& s) { s.materials[0].friction = 0.5; }),
              AllOf(HasSubstr("friction"), HasSubstr("0.5"), HasSubstr("\"default\""),
                    HasSubstr("must be 0")));
  EXPECT_THAT(refusal([](Scene& s) { s.materials[0].cohesion = 2; }), HasSubstr("cohesion"));
  EXPECT_THAT(refusal([](Scene& s) { s.materials[0].rolling_friction = 2; }),
              HasSubstr("rolling_friction"));
  EXPECT_THAT(refusal([](Scene& s) { s.materials[0].spinning_friction = 2; }),
              HasSubstr("spinning_friction"));
  EXPECT_THAT(refusal([](Scene& s) {
                physics::add_wall_box(s, {}, {0.1, 0.1, 0.1}, BodyKind::kinematic);
              }),
              AllOf(HasSubstr("body 2.kind"), HasSubstr("free or fixed")));
  EXPECT_THAT(refusal([](Scene& s) { s.bodies[1].locks = lock_x | lock_y; }),
              AllOf(HasSubstr("body 1.lock"), HasSubstr("2 locked axes")));
  EXPECT_THAT(refusal([](Scene& s) {
                ParticleSet set;
                set.position = {{5, 0, 0}};
                set.radius = 0.1;
                set.density = 1000;
                set.locks = lock_rotation;
                s.particles = {set};
              }),
              HasSubstr("particles.lock"));
  EXPECT_THAT(refusal([](Scene& s) {
                s.insertions.emplace_back();
                s.insertions[0].time = 0.1;
                s.insertions[0].bodies = {physics::sphere({5, 0, 0}, 0.1, 1)};
              }),
              HasSubstr("insertions"));
  EXPECT_THAT(refusal([](Scene& s) {
                s.periodicity.periodic = {false, false, true};
                s.periodicity.upper = {0, 0, 5};
                s.gravity = {0, 0, -9.81};
              }),
              AllOf(HasSubstr("gravity"), HasSubstr("along z")));
  EXPECT_THAT(refusal([](Scene& s) {
                Joint joint;
                joint.kind = JointKind::ball;
                joint.bodies = {0, 1};
                joint.anchor = {1, 0, 1};
                s.joints = {joint};
              }),
              HasSubstr("joints"));
  EXPECT_THAT(refusal([](Scene& s) { s.output.contact_frames = true; }),
              HasSubstr("output.contact_frames"));
  EXPECT_THAT(refusal([](Scene& s) { s.dynamics.parameters["max_impacts"] = 0; }),
              HasSubstr("dynamics.max_impacts"));
}

template <class Error, class Run>
std::string thrown(Run run) {
  try {
    run();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(VariationalRefusals, BodiesStartApart) {
  Scene scene = two_spheres();
  scene.bodies[1].position = {0.4, 0, 1};
  EXPECT_THAT(thrown<InputError>([&] { World(scene, cpu_options()); }),
              AllOf(HasSubstr("body 0 at"), HasSubstr("overlaps"), HasSubstr("0.1 m")));
  scene.bodies[1].position = {0.5, 0, 1};  // they touch
  EXPECT_EQ(thrown<InputError>([&] { World(scene, cpu_options()); }), "nothing");
  physics::add_plane(scene, {0, 0, 1}, {0, 0, 0.875});
  EXPECT_THAT(thrown<InputError>([&] { World(scene, cpu_options()); }), HasSubstr("0.125 m"));
}

/// A ball that loses speed with every bounce comes to rest.
TEST(VariationalRefusals, RestingContactsEndTheRun) {
  Scene scene = variational_scene(0.01, 0.5);
  scene.gravity = {0, 0, -9.81};
  physics::add_plane(scene);
  add_sphere(scene, {0, 0, 1.5}, 0.5, 1);
  World world(scene, cpu_options());
  std::int64_t steps = 0;
  const std::string message = thrown<RunError>([&] {
    for (; steps < 1000; ++steps) world.step();
  });
  EXPECT_THAT(message, AllOf(HasSubstr("body 1 comes to rest"), HasSubstr("0.04905 m/s"),
                             HasSubstr("\"rigid\"")));
  // Speeds are 4.43 e^k: the seventh bounce leaves with less than 0.049, after (1 + e - 2 e^7) / (1 - e) falls.
  const double fall = std::sqrt(2 / 9.81);
  EXPECT_NEAR(static_cast<double>(steps) * 0.01, fall * (1 + 2 * (0.5 - std::pow(0.5, 7)) / 0.5),
              0.03);
  EXPECT_EQ(world.steps_done(), steps) << "the step did not happen";
}

TEST(VariationalRefusals, WhatRestsFromTheStartEndsTheRun) {
  Scene scene = variational_scene(0.01, 1);
  scene.gravity = {0, 0, -9.81};
  physics::add_plane(scene);
  add_sphere(scene, {0, 0, 0.5}, 0.5, 1);
  World world(scene, cpu_options());
  EXPECT_THAT(thrown<RunError>([&] { world.step(); }),
              AllOf(HasSubstr("body 1 has more than 100 impacts"), HasSubstr("max_impacts")));
}

/// A ball between two walls that it hits a thousand times a step.
TEST(VariationalRefusals, TheNumberOfImpactsIsAParameter) {
  Scene scene = variational_scene(1);
  physics::add_plane(scene);
  physics::add_plane(scene, {0, 0, -1}, {0, 0, 1.125});
  add_sphere(scene, {0, 0, 0.5625}, 0.5, 1).velocity = {0, 0, 125};
  World refused(scene, cpu_options());
  EXPECT_THAT(thrown<RunError>([&] { refused.step(); }), HasSubstr("more than 100 impacts"));
  scene.dynamics.parameters["max_impacts"] = 1000;
  World world(scene, cpu_options());
  EXPECT_EQ(world.step().own[impacts], 1000);
  EXPECT_NEAR(world.states().position[2].z, 0.5625, 1e-9);
}

TEST(VariationalRefusals, StepsAreShortForPeriodicDomains) {
  Scene scene = variational_scene(0.1);
  scene.periodicity.periodic = {true, true, true};
  scene.periodicity.upper = {4, 4, 4};
  add_sphere(scene, {1, 1, 1}, 0.5, 1).velocity = {20, 0, 0};
  add_sphere(scene, {3, 1, 1}, 0.5, 1);
  World world(scene, cpu_options());
  EXPECT_THAT(thrown<RunError>([&] { world.step(); }),
              AllOf(HasSubstr("too far in a step of 0.1 s"), HasSubstr("period")));
}

TEST(VariationalRefusals, GravityAlongAPeriodicAxis) {
  Scene scene = variational_scene(0.01);
  scene.gravity = {};
  scene.periodicity.periodic = {true, false, false};
  scene.periodicity.upper = {4, 4, 4};
  add_sphere(scene, {1, 1, 1}, 0.5, 1);
  World world(scene, cpu_options());
  world.set_gravity({0, 0, -1});
  EXPECT_THAT(thrown<InputError>([&] { world.set_gravity({1, 0, 0}); }), HasSubstr("along x"));
  EXPECT_THAT(thrown<InputError>([&] { world.track_forces(); }), HasSubstr("track_forces()"));
}

/// The same with lists of neighbors, which would grow beyond all bounds before they hold.
TEST(VariationalRefusals, StepsOfManyBodiesAreShortForPeriodicDomains) {
  Scene scene = gas(5, 0.05, 0.05, 1);
  scene.bodies[7].velocity = {1000, 0, 0};
  World world(scene, cpu_options());
  EXPECT_THAT(thrown<RunError>([&] { world.step(); }), HasSubstr("too far in a step of 0.05 s"));
}

TEST(VariationalRefusals, WrittenStatesAreTakenOver) {
  Scene scene = two_spheres();
  World world(scene, cpu_options());
  const ArrayView velocity = world.array("velocity");
  ASSERT_EQ(velocity.type, DataType::float64) << "in double, whatever the precision of the run";
  static_cast<double*>(velocity.data)[0] = 7;
  world.arrays_changed(Written::velocities);
  world.step();
  const BodyStates states = world.states();
  EXPECT_NEAR(std::max(states.velocity[0].x, states.velocity[1].x), 7, 1e-15);
  world.set_velocity(0, {0, 0, 1});
  world.set_gravity({0, 0, -1});
  const StepReport report = world.step();
  EXPECT_NEAR(world.states().velocity[0].z, 0.99, 1e-15);
  EXPECT_EQ(report.body_count, 2);
  World other(scene, cpu_options());
  other.restore(world.save());
  other.step(), world.step();
  EXPECT_EQ(other.states().velocity[0].z, world.states().velocity[0].z)
      << "gravity is in the state";
}

}  // namespace
}  // namespace scree::test
