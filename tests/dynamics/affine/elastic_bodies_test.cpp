// Elastic bodies in scenes: closed forms of bars, momentum, and contact without intersections.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "dynamics/affine/affine_card.h"
#include "host/error.h"
#include "host/state_hash.h"
#include "tests/dynamics/affine/exact_surfaces.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/tetrahedra_box.h"

namespace scree::affine {
namespace {

using namespace test;
using physics::add_box;
using physics::add_plane;
using physics::kGravity;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kLength = 1, kDensity = 1000, kYoung = 1e7;

/// A bar that hangs from its upper end; it is one-dimensional, since it does not become thinner.
Scene hanging_bar(double time_step, double rule) {
  Scene scene = affine_scene(time_step, 0, rule);
  scene.dynamics.parameters["tolerance"] = 1e-7;
  add_elastic_box(scene, {0, 0, -0.5 * kLength}, {0.1, 0.1, kLength}, {1, 1, 20}, kDensity,
                  {kYoung, 0});
  scene.attachments.push_back({0, kWorldBody, {-1, -1, -1e-6}, {1, 1, 1e-6}});
  return scene;
}

/// How far the lower end is below where it was.
double sag(World& world) {
  double lowest = 0;
  int count = 0;
  double sum = 0;
  const std::vector<Vec3d> corners = world.states().bent.at(0);
  for (const Vec3d& x : corners) lowest = std::min(lowest, x.z);
  for (const Vec3d& x : corners)
    if (x.z < lowest + 0.5 * kLength / 20) sum += x.z, ++count;
  EXPECT_EQ(count, 4);
  return -sum / count - kLength;
}

TEST(ElasticBodies, ABarHangsAsLongAsItsWeightMakesIt) {
  World world(hanging_bar(0.1, 0), cpu_options());
  StepReport report;
  for (int k = 0; k < 60; ++k) report = world.step();
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.kinetic_energy, 1e-12);
  const double expected = kDensity * kGravity * kLength * kLength / (2 * kYoung);
  EXPECT_NEAR(sag(world), expected, 0.005 * expected);
  // The highest tetrahedra are stretched most, by what hangs below their middle.
  const double most = kDensity * kGravity * kLength * (1 - 0.5 / 20) / kYoung;
  EXPECT_NEAR(world.states().own[kStrainField][0], 2 * most, 0.02 * 2 * most);
  EXPECT_EQ(*static_cast<const double*>(world.array("strain").data),
            world.states().own[kStrainField][0]);
}

// Let go, the wave that starts at the fixed end takes the lower one to twice that way, and back.
TEST(ElasticBodies, ABarSwingsWithTheSpeedOfSound) {
  const double period = 4 * kLength / std::sqrt(kYoung / kDensity);
  const double expected = kDensity * kGravity * kLength * kLength / (2 * kYoung);
  World world(hanging_bar(period / 400, 1), cpu_options());
  for (int k = 0; k < 200; ++k) ASSERT_TRUE(world.step().converged);
  EXPECT_NEAR(sag(world), 2 * expected, 0.02 * expected);
  for (int k = 0; k < 200; ++k) ASSERT_TRUE(world.step().converged);
  EXPECT_NEAR(sag(world), 0, 0.04 * expected);
}

TEST(ElasticBodies, KeepTheirMomentum) {
  Scene scene = affine_scene(0.002, 0, 1);
  scene.gravity = {};
  scene.dynamics.parameters["tolerance"] = 1e-9;
  BodyDescription& box =
      add_elastic_box(scene, {1, 2, 3}, {0.1, 0.2, 0.3}, {2, 3, 4}, kDensity, {1e6, 0.4});
  box.velocity = {1, -2, 0.5};
  box.angular_velocity = {1, 2, 3};
  const double mass = box.mass;
  World world(scene, cpu_options());
  const StepReport first = world.step();
  StepReport report;
  for (int k = 0; k < 100; ++k) report = world.step();
  EXPECT_NEAR(report.own[momentum_x], mass, 1e-9);
  EXPECT_NEAR(report.own[momentum_y], -2 * mass, 1e-9);
  EXPECT_NEAR(report.own[momentum_z], 0.5 * mass, 1e-9);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(report.own[momentum_z + 1 + k], first.own[momentum_z + 1 + k], 1e-4 * mass);
  // Its pose is that of a body that turns as a stiff one does.
  const BodyStates s = world.states();
  EXPECT_NEAR(s.position[0].x, 1 + 101 * 0.002, 1e-9);
  EXPECT_NEAR(s.velocity[0].y, -2, 1e-9);
  EXPECT_NEAR(norm(s.angular_velocity[0]), std::sqrt(14.0), 0.2);
}

/// Whichever of the two comes, and whatever is on it: what one gives the other gets.
TEST(ElasticBodies, ShareTheMomentumOfAnImpactWithStiffOnes) {
  for (const bool elastic_comes : {false, true})
    for (const double time_step : {0.01, 0.002}) {
      SCOPED_TRACE(testing::Message() << elastic_comes << " " << time_step);
      Scene scene = affine_scene(time_step, 0, 1);
      scene.gravity = {};
      scene.dynamics.parameters["tolerance"] = 1e-7;
      BodyDescription& elastic =
          add_elastic_box(scene, {}, {0.2, 0.2, 0.2}, {2, 2, 2}, kDensity, {1e6, 0.3});
      const double mass = elastic.mass;
      if (elastic_comes) elastic.velocity = {-2, 0, 0};
      BodyDescription& stiff = add_box(scene, {-0.3, 0.02, 0.03}, {0.1, 0.1, 0.1}, mass);
      if (!elastic_comes) stiff.velocity = {2, 0, 0};
      World world(scene, cpu_options());
      const double momentum = (elastic_comes ? -2 : 2) * mass, energy = 2 * mass;
      bool met = false;
      for (int k = 0; k < 0.4 / time_step; ++k) {
        const StepReport report = world.step();
        ASSERT_TRUE(report.converged);
        EXPECT_NEAR(report.own[momentum_x], momentum, 1e-6 * mass);
        EXPECT_LE(report.kinetic_energy, energy * (1 + 1e-9));
        met = met || report.kinetic_energy < 0.8 * energy;
      }
      EXPECT_TRUE(met);
    }
}

Scene falling_elastic_boxes() {
  Scene scene = affine_scene(0.01, 0.3);
  scene.dynamics.parameters["reach"] = 2e-3;
  add_elastic_box(scene, {0, 0, 0.08}, {0.12, 0.1, 0.1}, {3, 2, 2}, kDensity, {3e4, 0.4});
  add_elastic_box(scene, {0.04, 0.01, 0.24}, {0.1, 0.1, 0.12}, {2, 2, 3}, kDensity, {3e4, 0.3})
      .orientation = exp_map(Vec3d{0.3, 0.2, 0.1});
  BodyDescription& ball = add_box(scene, {0.02, 0, 0.42}, {0.05, 0.05, 0.05}, 1);
  ball.orientation = exp_map(Vec3d{0.5, 0.4, 0});
  ball.velocity = {0, 0, -2};
  add_plane(scene);
  return scene;
}

TEST(ElasticBodies, NoTrianglesTouchInAnyStep) {
  const Scene scene = falling_elastic_boxes();
  const AffineSetup setup = affine_setup(scene);
  World world(scene, cpu_options());
  int contacts = 0;
  double squeezed = 1;
  for (int k = 0; k < 80; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged) << k;
    ASSERT_GT(report.own[min_gap], 0);
    contacts += report.contact_count;
    const BodyStates states = world.states();
    for (const auto& [id, corners] : states.bent) {
      double low = 1e300, high = -1e300;
      for (const Vec3d& x : corners) {
        ASSERT_GT(x.z, 0) << "step " << k;
        low = std::min(low, x.z), high = std::max(high, x.z);
      }
      if (id == 0) squeezed = std::min(squeezed, (high - low) / 0.1);
    }
    ASSERT_FALSE(triangles_touch(setup, world)) << "step " << k;
  }
  EXPECT_GT(contacts, 100);
  EXPECT_LT(squeezed, 0.97);
}

// What lies on the floor without moving is carried by it: the barrier gives as much as all weighs.
TEST(ElasticBodies, ComeToRestOnTheFloor) {
  Scene scene = falling_elastic_boxes();
  World world(scene, cpu_options());
  StepReport report;
  for (int k = 0; k < 300; ++k) report = world.step();
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.kinetic_energy, 1e-3);
  EXPECT_GT(report.own[min_gap], 0);
}

TEST(ElasticBodies, AreCarriedByWhatTheyAreAttachedTo) {
  Scene scene = affine_scene(0.005, 0);
  scene.dynamics.parameters["tolerance"] = 1e-8;
  add_elastic_box(scene, {0.3, 0, 0}, {0.4, 0.1, 0.05}, {4, 1, 1}, kDensity, {1e6, 0.3});
  BodyDescription& stiff = add_box(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, 8);
  stiff.angular_velocity = {0, 3, 0};
  scene.bodies[0].angular_velocity = {0, 3, 0};
  scene.bodies[0].velocity = cross(Vec3d{0, 3, 0}, Vec3d{0.3, 0, 0});
  scene.attachments.push_back({0, 1, {0.09, -1, -1}, {0.11, 1, 1}});
  double mass = 0, moment = 0;
  for (const BodyDescription& body : scene.bodies)
    mass += body.mass, moment += body.mass * body.velocity.z;
  World world(scene, cpu_options());
  const std::vector<Vec3d> start = world.states().bent.at(0);
  StepReport report;
  for (int k = 0; k < 100; ++k) report = world.step();
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(report.own[momentum_z], moment - mass * kGravity * 0.5, 1e-7 * mass);
  const BodyStates s = world.states();
  int attached = 0;
  for (std::size_t v = 0; v < start.size(); ++v) {
    if (start[v].x > 0.11) continue;
    ++attached;
    const Vec3d carried = s.position[1] + rotate(s.orientation[1], start[v]);
    EXPECT_LT(norm(s.bent.at(0)[v] - carried), 1e-5);
  }
  EXPECT_EQ(attached, 4);
}

TEST(ElasticBodies, FollowWhatIsLed) {
  Scene scene = affine_scene(0.01, 0);
  add_elastic_box(scene, {0, 0, 0.3}, {0.1, 0.1, 0.4}, {1, 1, 4}, kDensity, {1e6, 0.3});
  add_pusher(scene, {0, 0, 0}, {0.2, 0.2, 0.05}, {0.5, 0, 0});
  scene.attachments.push_back({0, 1, {-1, -1, 0.09}, {1, 1, 0.11}});
  World world(scene, cpu_options());
  StepReport report;
  for (int k = 0; k < 100; ++k) report = world.step();
  EXPECT_TRUE(report.converged);
  const BodyStates s = world.states();
  EXPECT_NEAR(s.position[1].x, 0.5, 2e-3);
  EXPECT_NEAR(s.position[0].x, 0.5, 0.02);
  EXPECT_NEAR(s.position[0].z, 0.3, 0.01);
}

TEST(ElasticBodies, AreTheSameOnEveryRunAndAfterARestart) {
  const Scene scene = falling_elastic_boxes();
  WorldOptions many = cpu_options();
  many.threads = 3;
  World one(scene, cpu_options()), other(scene, many), restarted(scene, cpu_options());
  for (int k = 0; k < 25; ++k) one.step(), other.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
  restarted.restore(one.save());
  for (int k = 0; k < 10; ++k) one.step(), restarted.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(restarted.states()));
  EXPECT_EQ(one.states().bent.at(1), restarted.states().bent.at(1));
}

// A kinematic body is where its motion begins, not where it is described.
TEST(ElasticBodies, WhatIsAttachedToAMovedBodyStartsWhereItIs) {
  Scene scene = affine_scene(0.001, 0, 1);
  scene.gravity = {};
  add_elastic_box(scene, {0, 0, 0.05}, {0.1, 0.1, 0.1}, {1, 1, 1}, kDensity, {1e6, 0.3});
  BodyDescription& holder =
      physics::add_wall_box(scene, {0, 0, -0.06}, {0.05, 0.05, 0.05}, BodyKind::kinematic);
  Motion motion;
  motion.kind = Motion::Kind::sampled;
  motion.times = {0, 1};
  motion.positions = {{0, 0, 0.005}, {0, 0, 0.005}};
  holder.motion = motion;
  scene.attachments.push_back({0, 1, {-1, -1, -1e-6}, {1, 1, 1e-6}});
  World world(scene, cpu_options());
  for (int k = 0; k < 10; ++k) EXPECT_LT(world.step().kinetic_energy, 1e-12);
}

TEST(ElasticBodies, TouchWallsWhateverGroupsOthersHave) {
  Scene scene = affine_scene(0.01, 0, 1);
  add_elastic_box(scene, {0, 0, 0.051}, {0.1, 0.1, 0.1}, {1, 1, 1}, kDensity, {1e6, 0.3});
  physics::add_wall_box(scene, {0, 0, -0.5}, {1, 1, 0.5});
  physics::add_box(scene, {0, 0, 5}, {0.05, 0.05, 0.05}, 1).collision_group = kRestingGroup - 1;
  World world(scene, cpu_options());
  for (int k = 0; k < 40; ++k) world.step();
  EXPECT_GT(world.states().position[0].z, 0.045);
}

/// Surfaces do not cross where one body is inside of another.
TEST(ElasticBodies, WhatIsInsideOfAnotherIsTold) {
  const auto warnings = [](const Vec3d& at, const std::function<void(Scene&)>& add_other) {
    Scene scene = affine_scene(0.01, 0);
    add_elastic_box(scene, at, {0.1, 0.1, 0.1}, {1, 1, 1}, kDensity, {1e6, 0.3});
    add_other(scene);
    const World world(scene, cpu_options());
    return world.warnings();
  };
  const auto box = [](double half, BodyKind kind) {
    return [=](Scene& s) {
      if (kind == BodyKind::free)
        physics::add_box(s, {}, {half, half, half}, 1);
      else
        physics::add_wall_box(s, {}, {half, half, half});
    };
  };
  const auto floor = [](Scene& s) { physics::add_plane(s); };
  EXPECT_THAT(warnings({}, box(0.5, BodyKind::fixed)),
              ElementsAre(HasSubstr("body 0 starts inside of body 1")));
  EXPECT_THAT(warnings({}, box(0.5, BodyKind::free)), ElementsAre(HasSubstr("inside of body 1")));
  EXPECT_THAT(warnings({}, box(0.02, BodyKind::free)),
              ElementsAre(HasSubstr("body 1 starts inside of body 0")));
  EXPECT_THAT(warnings({0, 0, -1}, floor), ElementsAre(HasSubstr("inside of body 1")));
  EXPECT_THAT(warnings({0, 0, 1}, floor), ElementsAre());
  EXPECT_THAT(warnings({2, 0, 0}, box(0.5, BodyKind::fixed)), ElementsAre());
}

std::string refusal_of_elastic(const std::function<void(Scene&)>& change) {
  Scene scene = affine_scene(0.01, 0);
  add_elastic_box(scene, {}, {0.1, 0.1, 0.1}, {1, 1, 1}, kDensity, {1e6, 0.3});
  add_box(scene, {1, 0, 0}, {0.1, 0.1, 0.1}, 1);
  change(scene);
  try {
    const World world(scene, cpu_options());
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(ElasticBodies, WhatTheyCannotBeIsNamed) {
  EXPECT_EQ(refusal_of_elastic([](Scene&) {}), "nothing");
  const auto elastic = [](double young, double poisson) {
    return refusal_of_elastic([=](Scene& s) { s.bodies[0].elastic = Elasticity{young, poisson}; });
  };
  EXPECT_THAT(elastic(-1, 0.3), AllOf(HasSubstr("young_modulus: -1"), HasSubstr("positive")));
  EXPECT_THAT(elastic(1e6, 0.5), AllOf(HasSubstr("poisson_ratio: 0.5"), HasSubstr("below 0.5")));
  EXPECT_THAT(elastic(1e6, -0.1), HasSubstr("0 or more")) << "tetrahedra fell together";
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.bodies[1].elastic = Elasticity{1e6, 0.3};
              }),
              HasSubstr("tetrahedra"));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) { s.bodies[0].locks = lock_x; }),
              HasSubstr("attach"));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.bodies[0].load = Load{{}, {0, 0, 1}};
              }),
              HasSubstr("torque"));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.bodies.push_back(s.bodies[0]);
                s.bodies.back().position = {0, 0, 1};
              }),
              HasSubstr("another elastic body has it"));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                Joint joint;
                joint.kind = JointKind::ball;
                joint.bodies = {0, 1};
                s.joints.push_back(joint);
              }),
              AllOf(HasSubstr("joints[0]"), HasSubstr("attachments hold elastic bodies")));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.attachments.push_back({0, 1, {5, 5, 5}, {6, 6, 6}});
              }),
              AllOf(HasSubstr("attachments[0].box"), HasSubstr("must hold a corner of body 0")));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.attachments.push_back({0, kWorldBody, {-5, -5, -5}, {6, 6, 6}});
              }),
              HasSubstr("must leave a corner of body 0 loose"));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.attachments.push_back({1, 0, {}, {}});
              }),
              AllOf(HasSubstr("attachments[0].body"), HasSubstr("elastic")));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.attachments.push_back({0, 0, {}, {}});
              }),
              HasSubstr("attachments[0].to"));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.attachments.push_back({0, 1, {1, 1, 1}, {}});
              }),
              HasSubstr("lower corner"));
  EXPECT_THAT(refusal_of_elastic([](Scene& s) {
                s.bodies[1].position = {0.1, 0, 0};
              }),
              HasSubstr("body 0 and body 1 intersect"));
}

}  // namespace
}  // namespace scree::affine
