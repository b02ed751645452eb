// Affine bodies in scenes: held to AffineSystem, which assembles and factorizes every matrix, and to closed forms.

#include <gtest/gtest.h>

#include "dynamics/affine/affine_card.h"
#include "dynamics/affine/affine_setup.h"
#include "host/compounds.h"
#include "host/error.h"
#include "host/scene_reader.h"
#include "host/state_hash.h"
#include "shapes/box.h"
#include "shapes/mesh.h"
#include "tests/affine_reference/affine_system.h"
#include "tests/box_mesh.h"
#include "tests/dynamics/affine/exact_surfaces.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/physics/joint_scenes.h"

namespace scree::affine {
namespace {

using namespace test;
using physics::add_box;
using physics::add_plane;
using physics::kGravity;

/// The scene as the reference takes it.
AffineSystem reference_of(const Scene& scene) {
  const auto& values = scene.dynamics.parameters;
  AffineSettings settings;
  settings.h = scene.stepping.time_step;
  settings.gravity = scene.gravity;
  settings.rule = static_cast<StepRule>(std::lround(values.at("rule")));
  settings.barrier.reach = values.at("reach");
  settings.barrier.stiffness = values.at("barrier_stiffness");
  settings.mu = scene.materials[0].friction;
  settings.tolerance = values.at("tolerance");
  AffineSystem system(settings);
  const AffineSetup setup = affine_setup(scene);
  for (std::size_t b = 0; b < setup.bodies.size(); ++b) {
    AffineBody body;
    body.surface = setup.surfaces[static_cast<std::size_t>(setup.surface_of_body[b])];
    body.mass = setup.bodies[b].mass;
    body.stiffness = setup.bodies[b].stiffness;
    body.position = setup.position[b], body.velocity = setup.velocity[b];
    body.fixed = setup.bodies[b].row < 0;
    system.add(body);
  }
  return system;
}

/// Nodes of the moving bodies, four rows each.
std::vector<Vec3d> nodes_of(World& world) { return world.save().at<Vec3d>("affine/position"); }

TEST(AffineModel, MovesAsTheReferenceUntilTheyFindOtherMinima) {
  for (const double rule : {0.0, 1.0, 2.0}) {
    SCOPED_TRACE(rule);
    Scene scene = falling_boxes(rule);
    scene.dynamics.parameters["friction_solves"] = 1;  // as the reference
    AffineSystem reference = reference_of(scene);
    World world(scene, cpu_options());
    int contacts = 0, steps = 0;
    for (bool is_same = true; is_same && steps < 40; ++steps) {
      const StepReport report = world.step();
      const std::vector<Vec3d> nodes = nodes_of(world);
      std::vector<AffineVec> places;
      for (const AffineBody& body : reference.bodies()) places.push_back(body.position);
      for (std::size_t i = 0; i < nodes.size(); ++i) places[i / 4].node[i % 4] = nodes[i];
      const AffineReport expected = reference.step(places);
      ASSERT_TRUE(expected.converged && report.converged) << steps;
      contacts += report.contact_count;
      double apart = 0;
      for (std::size_t b = 0; b < places.size(); ++b)
        for (int n = 0; n < 4; ++n)
          apart = std::max(apart, norm(places[b].node[n] - reference.bodies()[b].position.node[n]));
      // Newton's method may come to different minima, from which on the runs are different ones.
      is_same = apart < 1e-6;
      if (!is_same) {
        EXPECT_LT(expected.above, 0) << steps;
      }
    }
    EXPECT_GE(steps, 20);
    EXPECT_GT(contacts, 50);
  }
}

TEST(AffineModel, NoTrianglesTouchInAnyStep) {
  const Scene scene = falling_boxes(1);
  const AffineSetup setup = affine_setup(scene);
  World world(scene, cpu_options());
  for (int k = 0; k < 100; ++k) {
    const StepReport report = world.step();
    ASSERT_GT(report.own[min_gap], 0);
    ASSERT_FALSE(affine::triangles_touch(setup, world)) << "step " << k;
  }
}

// What frames show is the state, not the rigid pose nearest to it.
TEST(AffineModel, StatesHaveTheStrainOfBodies) {
  Scene scene = affine_scene(0.01, 0.3);
  scene.dynamics.parameters["stiffness"] = 1e5;
  physics::add_wall_box(scene, {0, 0, -0.1}, {2, 2, 0.1});
  add_box(scene, {0, 0, 0.51}, {0.5, 0.5, 0.5}, 1000);
  add_box(scene, {0, 0, 1.52}, {0.5, 0.5, 0.5}, 2000);
  World world(scene, cpu_options());
  for (int k = 0; k < 50; ++k) world.step();
  const BodyStates states = world.states();
  const std::vector<Vec3d> nodes = nodes_of(world);
  ASSERT_EQ(states.axes.size(), 3u);
  ASSERT_EQ(states.own.at(kStrainField).size(), 3u);
  const ArrayView array = world.array("strain");
  ASSERT_EQ(array.shape[0], 2);
  for (std::size_t body = 0; body < 2; ++body) {  // of ids 1 and 2
    AffineVec q;
    for (std::size_t k = 0; k < 4; ++k) q.node[k] = nodes[4 * body + k];
    EXPECT_EQ(states.position[body + 1], q.node[0]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(states.axes[body + 1][k], q.node[k + 1]);
    EXPECT_EQ(states.own[kStrainField][body + 1], strain_norm(q));
    EXPECT_EQ(static_cast<const double*>(array.data)[body], strain_norm(q));
  }
  EXPECT_EQ(states.axes[0], (std::array<Vec3d, 3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}));
  EXPECT_EQ(states.own[kStrainField][0], 0);
  EXPECT_GT(states.own[kStrainField][1], states.own[kStrainField][2]);
  EXPECT_GT(states.own[kStrainField][2], 0.01);
}

TEST(AffineModel, A85FreeBodiesKeepTheirMomentumToRounding) {
  Scene scene = affine_scene(0.01, 0);
  scene.gravity = {};
  BodyDescription& box = add_box(scene, {}, {0.1, 0.2, 0.3}, 5);
  box.velocity = {1e-5, -2, 0.5};  // the first is far below the tolerance of a step
  box.angular_velocity = {1, 2, 3};
  World world(scene, cpu_options());
  StepReport report;
  for (int k = 0; k < 1000; ++k) report = world.step();
  EXPECT_NEAR(report.own[momentum_x], 5e-5, 1e-12);
  EXPECT_NEAR(report.own[momentum_y], -10, 1e-11);
  EXPECT_NEAR(report.own[momentum_z], 2.5, 1e-11);
  EXPECT_NEAR(world.states().position[0].x, 1e-4, 1e-11);
  EXPECT_LT(report.own[max_strain], 1e-3);
}

// rho a^2 w^2 / (48 kappa) of a cube that spins about an axis of it, averaged over the vibrations with which it starts.
TEST(AffineModel, A82ASpinningCubeStretches) {
  Scene scene = affine_scene(1e-5, 0);
  scene.gravity = {};
  scene.dynamics.parameters["stiffness"] = 1e8;
  scene.dynamics.parameters["tolerance"] = 1e-9;
  add_box(scene, {}, {0.05, 0.05, 0.05}, 1).angular_velocity = {0, 0, 100};
  World world(scene, cpu_options());
  double sum = 0;
  constexpr int kSteps = 1000;
  for (int k = 0; k < kSteps; ++k) {
    world.step();
    const std::vector<Vec3d> nodes = nodes_of(world);
    sum += 0.5 * (norm2(nodes[1]) + norm2(nodes[2])) - 1;
  }
  EXPECT_NEAR(sum / kSteps, 2.0833e-5, 0.02 * 2.0833e-5);
}

// With n equal contacts and y = d^2: kappa n (d/dd) of -(y - s)^2 ln(y / s) is m g.
TEST(AffineModel, A81ABlockRestsWhereTheBarrierCarriesIt) {
  Scene scene = affine_scene(0.01, 0.5);
  scene.dynamics.parameters["barrier_stiffness"] = 1e12;
  scene.dynamics.parameters["reach"] = 1e-3;
  scene.dynamics.parameters["tolerance"] = 1e-9;
  add_plane(scene);
  add_box(scene, {0, 0, 0.1008}, {0.1, 0.1, 0.1}, 8);
  World world(scene, cpu_options());
  StepReport report;
  for (int k = 0; k < 100; ++k) report = world.step();
  EXPECT_EQ(report.contact_count, 4);
  const double s = 1e-6;
  double low = 1e-9, high = 1e-3;
  for (int k = 0; k < 200; ++k) {  // the force falls with the gap
    const double d = 0.5 * (low + high), y = d * d;
    const double force = 4 * 1e12 * 2 * d * (2 * (y - s) * std::log(y / s) + (y - s) * (y - s) / y);
    (force > 8 * kGravity ? low : high) = d;
  }
  EXPECT_NEAR(report.own[min_gap], low, 1e-3 * low);
}

// Friction below its bound creeps at eps (1 - sqrt(1 - tan(theta) / mu)), VALIDATION A80.
TEST(AffineModel, A80ABlockOnASlopeCreepsAsTheSmoothedLawSays) {
  for (const double slip_speed : {1e-3, 5e-4}) {
    Scene scene = affine_scene(0.01, 0.5);
    physics::tilt(scene, 20);
    scene.dynamics.parameters["slip_speed"] = slip_speed;
    scene.dynamics.parameters["tolerance"] = 1e-8;
    add_plane(scene);
    add_box(scene, {0, 0, 0.0505}, {0.1, 0.1, 0.05}, 4);
    World world(scene, cpu_options());
    for (int k = 0; k < 200; ++k) world.step();
    EXPECT_NEAR(world.states().velocity[1].x, 0.47840 * slip_speed, 0.01 * 0.47840 * slip_speed);
  }
}

TEST(AffineModel, ABlockOnASteepSlopeSlidesAsCoulombSays) {
  Scene scene = affine_scene(0.01, 0.4);
  physics::tilt(scene, 25);
  add_plane(scene);
  add_box(scene, {0, 0, 0.0505}, {0.1, 0.1, 0.05}, 4);
  World world(scene, cpu_options());
  for (int k = 0; k < 20; ++k) world.step();
  const double from = world.states().velocity[1].x;
  for (int k = 0; k < 100; ++k) world.step();
  const double slope = physics::radians(25);
  const double expected = kGravity * (std::sin(slope) - 0.4 * std::cos(slope));
  EXPECT_NEAR(world.states().velocity[1].x - from, expected, 0.01 * expected);
}

// A flat box that slides flush stays so, from the first step on: friction that lags behind the normal force by a step lets it rock and
// take off.
TEST(AffineModel, ABoxSlidesFlushAtAnySlopeAndStep) {
  struct Slide {
    double degrees, friction, time_step, duration;
  };
  for (const Slide& slide : {Slide{60, 0.8, 1e-3, 2}, {85, 1, 1e-3, 2}, {45, 0.5, 0.05, 1}}) {
    SCOPED_TRACE(slide.degrees);
    Scene scene =
        affine_scene(slide.time_step, slide.friction, static_cast<double>(StepRule::bdf2));
    physics::tilt(scene, slide.degrees);
    add_plane(scene);
    add_box(scene, {0, 0, 0.0504}, {0.1, 0.1, 0.05}, 4);
    World world(scene, cpu_options());
    const double slope = physics::radians(slide.degrees);
    const double expected = kGravity * (std::sin(slope) - slide.friction * std::cos(slope));
    const auto steps = std::lround(slide.duration / slide.time_step);
    for (long k = 0; k < steps; ++k) world.step();
    EXPECT_NEAR(world.states().velocity[1].x, expected * slide.duration,
                3e-3 * expected * slide.duration);
    EXPECT_LT(norm(world.states().angular_velocity[1]), 1e-3);
  }
}

// A contact that sticks is stiff: its Newton step is short however much it lacks to hold. Tolerances of a large scene are longer:
// that of one of 20 m is 2 cm/s a step, and its share of the speed is off by as much.
TEST(AffineModel, ABlockSlidesInALargeScene) {
  for (const double length : {1.0, 5.0, 20.0}) {
    for (const double friction : {0.2, 0.3, 0.35}) {
      Scene scene = affine_scene(0.01, friction);
      physics::tilt(scene, 20);
      physics::add_wall_box(scene, {0.4 * length, 0, -0.05}, {0.5 * length, 0.2, 0.05});
      scene.dynamics.parameters["reach"] = 1e-3;
      add_box(scene, {0, 0, 0.0255}, {0.05, 0.05, 0.025}, 0.5);
      World world(scene, cpu_options());
      const int body = 1;
      const double slope = physics::radians(20);
      const double expected = kGravity * (std::sin(slope) - friction * std::cos(slope));
      for (int k = 0; k < 10; ++k) world.step();
      const double from = world.states().velocity[body].x;
      for (int k = 0; k < 20; ++k) world.step();
      EXPECT_NEAR(world.states().velocity[body].x - from, 0.2 * expected,
                  (length > 5 ? 0.2 : 0.03) * 0.2 * expected + 2e-3)
          << length << " m, friction " << friction;
    }
  }
}

// A strained body that no prescribed one can reach does not stop it.
TEST(AffineModel, APrescribedBodyMovesBesideASqueezedOne) {
  Scene scene = affine_scene(0.01, 0.5);
  scene.dynamics.parameters["reach"] = 1e-3;
  physics::add_wall_box(scene, {0, 0, -0.5}, {1, 1, 0.5});
  add_box(scene, {0, 0, 0.0508}, {0.05, 0.05, 0.05}, 1);
  add_box(scene, {0, 0, 0.1518}, {0.05, 0.05, 0.05}, 1e4);
  add_pusher(scene, {10, 0, 1}, {0.25, 0.25, 0.025}, {0, 0.5, 0});
  World world(scene, cpu_options());
  StepReport report;
  for (int k = 0; k < 20; ++k) report = world.step();
  EXPECT_GT(report.own[max_strain], 0.01);
  EXPECT_EQ(report.own[blocked], 0);
  EXPECT_NEAR(world.states().position[3].y, 0.1, 1e-4);
}

/// A rod that hangs by a hinge at its end.
Scene hinged_rod(double rule, double h) {
  Scene scene = affine_scene(h, 0, rule);
  scene.dynamics.parameters["tolerance"] = 1e-8;
  BodyDescription& rod = add_box(scene, {}, {0.01, 0.01, 0.5}, 1);
  const double angle = physics::radians(60);
  rod.orientation = exp_map(Vec3d{0, angle, 0});
  rod.position = rotate(rod.orientation, Vec3d{0, 0, -0.5});
  scene.joints = {physics::joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0})};
  return scene;
}

// A compound pendulum from 60 degrees: 1.0731820 (elliptic integral) times that of small swings.
TEST(AffineModel, AHingedRodSwingsWithItsPeriod) {
  World world(hinged_rod(1, 0.002), cpu_options());
  std::vector<double> crossings;
  double before = -1, largest_error = 0;
  for (int k = 0; k < 2700; ++k) {
    world.step();
    const BodyStates states = world.states();
    const double x = states.position[0].x;
    if (before * x < 0) crossings.push_back(world.time() - 0.002 * x / (x - before));
    before = x;
    const std::vector<Vec3d> node = nodes_of(world);
    largest_error = std::max(largest_error, norm(node[0] + 0.5 * node[3]));
  }
  ASSERT_GE(crossings.size(), 5u);
  const double inertia = (1 + 0.02 * 0.02) / 12 + 0.25;
  const double period = 1.0731820 * 2 * physics::kPi * std::sqrt(inertia / (0.5 * kGravity));
  EXPECT_NEAR((crossings[4] - crossings[0]) / (2 * period), 1, 5e-4);
  EXPECT_LT(largest_error, 1e-12);
}

// Stiffer barriers press contacts into the last hundredths of their reach, where a step took 158 iterations.
TEST(AffineModel, AHouseOfCardsAtRestTakesFewIterations) {
  const Scene scene = read_scene(SCREE_SCENE_DIR "/house_of_cards.json", {});
  World world(scene, cpu_options());
  for (int k = 0; k < 11; ++k) world.step();
  const StepReport report = world.step();
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.iterations, 4);
  EXPECT_GT(report.contact_count, 1000);
  EXPECT_GT(report.own[min_gap], 0.02 * 2e-4);
}

/// A box off the axis that holds it, which leads down a slope.
Scene box_on_an_axis(JointKind kind, const Vec3d& axis) {
  Scene scene = affine_scene(0.01, 0, 0);
  scene.dynamics.parameters["tolerance"] = 1e-9;
  add_box(scene, {0, 0, 0.3}, {0.1, 0.2, 0.3}, 2);
  Joint joint;
  joint.kind = kind;
  joint.bodies = {kWorldBody, 0};
  joint.axis = axis;
  joint.anchor = {0, 0.1, 0.3};
  scene.joints.push_back(joint);
  return scene;
}

// Implicit Euler falls g sin(slope) t (t + h) / 2.
TEST(AffineModel, ASliderGoesStraightDownItsAxis) {
  const Vec3d axis{0.8, 0, -0.6};
  World world(box_on_an_axis(JointKind::slider, axis), cpu_options());
  for (int k = 0; k < 100; ++k) world.step();
  const BodyStates states = world.states();
  const double way = 0.6 * kGravity * 1.0 * 1.01 / 2;
  EXPECT_LT(norm(states.position[0] - Vec3d{0, 0, 0.3} - way * axis), 1e-9);
  EXPECT_LT(norm(states.angular_velocity[0]), 1e-9);
}

// A fixed body holds the axis as the world does, and what joins them lets them overlap.
TEST(AffineModel, ASliderGoesThroughTheFixedBodyThatHoldsIt) {
  const Vec3d axis{0.8, 0, -0.6};
  Scene scene = box_on_an_axis(JointKind::slider, axis);
  physics::add_wall_box(scene, {0.4, 0, 0}, {0.05, 0.3, 0.3});
  scene.joints[0].bodies = {1, 0};
  World world(scene, cpu_options());
  for (int k = 0; k < 50; ++k) world.step();
  const double way = 0.6 * kGravity * 0.5 * 0.51 / 2;
  EXPECT_LT(norm(world.states().position[0] - Vec3d{0, 0, 0.3} - way * axis), 1e-9);
}

// About its axis it turns as a pendulum too, and leaves it nowhere.
TEST(AffineModel, ACylindricalJointTurnsAsItSlides) {
  const Vec3d axis{1, 0, 0};
  Scene scene = box_on_an_axis(JointKind::cylindrical, axis);
  scene.bodies[0].velocity = {0.5, 0, 0};
  World world(scene, cpu_options());
  for (int k = 0; k < 50; ++k) world.step();
  const BodyStates states = world.states();
  EXPECT_NEAR(states.position[0].x, 0.25, 1e-9);
  const std::vector<Vec3d> node = nodes_of(world);
  const Vec3d anchor = node[0] + 0.1 * node[2];
  EXPECT_LT(norm(Vec3d{0, anchor.y - 0.1, anchor.z - 0.3}), 1e-9);
  EXPECT_GT(std::abs(states.angular_velocity[0].x), 1);
  EXPECT_LT(std::abs(states.angular_velocity[0].y) + std::abs(states.angular_velocity[0].z), 1e-9);
}

TEST(AffineModel, ResumedRunsHaveTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = falling_boxes(1);
  World one(scene, cpu_options(1));
  for (int k = 0; k < 30; ++k) one.step();
  const WorldState state = one.save();
  for (int k = 0; k < 30; ++k) one.step();
  World other(scene, cpu_options(4));
  other.restore(state);
  for (int k = 0; k < 30; ++k) other.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
}

/// Gaps are what is left of coordinates, here of a plane that is some hundred times as large as the block.
TEST(AffineModel, StepsOfABlockAtRestOnASlopeEndBeforeRounding) {
  Scene scene = affine_scene(0.01, 0.5, 1);
  scene.dynamics.parameters["reach"] = 5e-4;
  scene.dynamics.parameters["slip_speed"] = 1e-4;
  scene.dynamics.parameters["tolerance"] = 1e-6;
  const double slope = physics::kPi / 9;
  add_plane(scene, {std::sin(slope), 0, std::cos(slope)});
  const Vec3d normal{std::sin(slope), 0, std::cos(slope)};
  add_box(scene, 0.0504 * normal, {0.05, 0.05, 0.05}, 1).orientation =
      exp_map(slope * Vec3d{0, 1, 0});
  World world(scene, cpu_options());
  for (int k = 0; k < 600; ++k) {
    const StepReport report = world.step();
    ASSERT_TRUE(report.converged) << k;
    ASSERT_LT(report.iterations, 20) << k;
  }
}

/// Boxes that fly keep a list of near pairs for several steps, and what else it holds decides last bits.
TEST(AffineModel, RunsThatAreResumedInFlightHaveTheSameBits) {
  const Scene scene = falling_boxes(1);
  World one(scene, cpu_options(1));
  const auto steps_of_list = [](WorldState& state) {
    return state.at<double>("affine/near_list")[2];
  };
  int steps = 0;
  WorldState state;
  do {
    one.step();
    state = one.save();
  } while (++steps < 60 && steps_of_list(state) < 4);
  ASSERT_EQ(steps_of_list(state), 4);
  one.step();
  state = one.save();  // the list serves on
  ASSERT_EQ(steps_of_list(state), 4);
  World other(scene, cpu_options(2));
  other.restore(state);
  for (int k = 0; k < 60; ++k) one.step(), other.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
  state.at<double>("affine/near_list")[0] = 2;
  EXPECT_THROW(other.restore(state), InputError);
}

/// A cube that turns by 1.2 rad a step.
Scene spinning_cube(double max_turn) {
  Scene scene = affine_scene(0.02, 0);
  scene.gravity = {};
  scene.dynamics.parameters["rule"] = static_cast<double>(StepRule::bdf2);
  scene.dynamics.parameters["max_turn"] = max_turn;
  add_box(scene, {}, {0.05, 0.05, 0.05}, 1).angular_velocity = {0, 0, 60};
  return scene;
}

TEST(AffineModel, StepsInWhichBodiesTurnFarAreMadeInPartsWhereAllowed) {
  World in_one(spinning_cube(0), cpu_options()), in_parts(spinning_cube(0.02), cpu_options());
  const double energy = 0.5 * (2.0 / 3 * 0.05 * 0.05) * 60 * 60;
  StepReport coarse, fine;
  for (int k = 0; k < 10; ++k) {
    coarse = in_one.step(), fine = in_parts.step();
    EXPECT_EQ(coarse.own[kPartsColumn], 1);
    EXPECT_EQ(fine.own[kPartsColumn], 64);
    EXPECT_LE(fine.max_turn, 0.02);
    EXPECT_GT(coarse.max_turn, 0.02);
  }
  EXPECT_EQ(fine.step, 10);
  EXPECT_NEAR(in_parts.time(), 0.2, 1e-14);
  EXPECT_LT(coarse.kinetic_energy, 0.9 * energy);
  EXPECT_NEAR(fine.kinetic_energy, energy, 0.01 * energy);
}

/// A spin that comes to rest: steps of ever fewer parts, each of half those of the one before at least.
TEST(AffineModel, PartsOfStepsFollowTheTurnAndResumedRunsHaveTheSameBits) {
  Scene scene = spinning_cube(0.1);
  scene.gravity = {0, 0, -9.81};
  scene.materials[0].friction = 0.8;
  scene.bodies[0].position = {0, 0, 0.06};
  scene.bodies[0].angular_velocity = {40, 0, 0};
  add_plane(scene);
  constexpr int kSteps = 60;  // it tumbles for some four seconds
  World one(scene, cpu_options(1));
  WorldState state;
  double parts = 0, before = 0, least = 1e300;
  for (int k = 0; k < kSteps; ++k) {
    if (k == 4) state = one.save();
    const StepReport report = one.step();
    if (k == 0) parts = report.own[kPartsColumn];
    if (k > 0) {
      EXPECT_GE(report.own[kPartsColumn], 0.5 * before);
    }
    before = report.own[kPartsColumn];
    least = std::min(least, before);
  }
  EXPECT_GE(parts, 8);
  EXPECT_EQ(least, 1);
  World other(scene, cpu_options(2));
  other.restore(state);
  for (int k = 4; k < kSteps; ++k) other.step();
  EXPECT_EQ(state_hash(one.states()), state_hash(other.states()));
  state.at<double>("affine/earlier_step") = {-1};
  EXPECT_THROW(other.restore(state), InputError);
}

TEST(AffineModel, ALedBoxPushesAndStopsWhereItIsBlocked) {
  Scene scene = affine_scene(0.01, 0);
  scene.gravity = {};
  add_box(scene, {0.3, 0, 0}, {0.1, 0.1, 0.1}, 8);
  physics::add_wall_box(scene, {1.0, 0, 0}, {0.1, 0.3, 0.3});
  add_pusher(scene, {0, 0, 0}, {0.1, 0.1, 0.1}, {1, 0, 0});
  World world(scene, cpu_options());
  StepReport report;
  for (int k = 0; k < 40; ++k) {
    report = world.step();
    EXPECT_EQ(report.own[blocked], 0) << k;
  }
  EXPECT_NEAR(world.states().position[2].x, 0.4, 0.01 * 0.4);
  EXPECT_GT(world.states().position[0].x, 0.6);
  for (int k = 0; k < 40; ++k) report = world.step();
  EXPECT_EQ(report.own[blocked], 1);
  EXPECT_GT(report.own[min_gap], 0);
  EXPECT_LT(world.states().position[0].x, 0.8);
  EXPECT_LT(world.states().position[2].x, 0.6);
  EXPECT_LT(report.own[max_strain], 0.02);
}

TEST(AffineModel, LoadsOfABodyMoveAndTurnIt) {
  Scene scene = affine_scene(0.001, 0);
  scene.gravity = {};
  BodyDescription& box = add_box(scene, {}, {0.1, 0.1, 0.1}, 8);
  Load load;
  load.force = {4, 0, -2};
  load.torque = {0, 0, 0.01};
  box.load = load;
  const double inertia = box.inertia.z;
  World world(scene, cpu_options());
  for (int k = 0; k < 1000; ++k) world.step();
  const BodyStates states = world.states();
  EXPECT_LT(norm(states.velocity[0] - Vec3d{0.5, 0, -0.25}), 1e-9);
  EXPECT_NEAR(states.angular_velocity[0].z, 0.01 / inertia, 1e-3 * 0.01 / inertia);
}

TEST(AffineModel, BodiesOfOneCollisionGroupPassThroughEachOther) {
  for (const bool grouped : {false, true}) {
    Scene scene = affine_scene(0.01, 0);
    scene.gravity = {};
    add_box(scene, {}, {0.1, 0.1, 0.1}, 8).velocity = {1, 0, 0};
    add_box(scene, {0.3, 0, 0}, {0.1, 0.1, 0.1}, 8);
    for (BodyDescription& body : scene.bodies) body.collision_group = grouped ? 3 : -1;
    World world(scene, cpu_options());
    for (int k = 0; k < 50; ++k) world.step();
    EXPECT_EQ(world.states().position[0].x > world.states().position[1].x, grouped);
  }
}

TEST(AffineModel, FixedAndKinematicBodiesMayIntersectEachOther) {
  Scene scene = affine_scene(0.01, 0);
  add_box(scene, {0, 0, 1}, {0.1, 0.1, 0.1}, 8);
  physics::add_wall_box(scene, {}, {0.1, 0.1, 0.1});
  physics::add_wall_box(scene, {0.05, 0.03, 0}, {0.1, 0.1, 0.1}, BodyKind::kinematic);
  World world(scene, cpu_options());
  EXPECT_TRUE(world.step().converged);
}

// A needle through the middle of a large triangle: none of their corners and edges are near each other.
TEST(AffineModel, ANeedleThroughAFloorIsRefused) {
  Scene scene = affine_scene(0.01, 0);
  add_plane(scene);
  add_box(scene, {0.1, 0.2, 0.1}, {0.001, 0.001, 0.5}, 1);
  EXPECT_THROW(World(scene, cpu_options()), InputError);
}

/// Also bodies behind compounds, whose parts have places of their own.
TEST(AffineModel, CompoundsAreDrawnAsRigidOnesAre) {
  Scene scene = affine_scene(0.01, 0);
  BodyDescription cross;
  std::vector<ShapePart> parts(2);
  for (ShapePart& part : parts) part.shape.kind = shapes::Box::kind;
  parts[0].shape.half_extents = {0.3, 0.1, 0.1};
  parts[1].shape.half_extents = {0.1, 0.1, 0.4};
  parts[1].position = {0.1, 0, 0.2};
  cross.position = {0, 0, 1};
  set_compound(scene, cross, parts);
  set_mass_from_density(cross, 1000);
  scene.bodies.push_back(cross);
  add_box(scene, {0.5, 1, 0.5}, {0.2, 0.2, 0.2}, 1);
  BodyDescription wall;
  wall.kind = BodyKind::fixed;
  wall.shape.kind = shapes::Mesh::kind;
  wall.shape.mesh = static_cast<int>(scene.meshes.size());
  wall.position = {-1, 0, 0};
  scene.meshes.push_back(scree::test::box_mesh({0.2, 0.3, 0.4}, {}));
  scene.bodies.push_back(wall);
  PictureSettings settings;
  settings.width = 160, settings.height = 120, settings.labels = false;
  World world(scene, cpu_options());
  const Image affine = world.render(settings);
  scene.dynamics = {};
  EXPECT_EQ(affine.rgb, World(scene, cpu_options()).render(settings).rgb);
  scene.bodies.erase(scene.bodies.begin());
  EXPECT_NE(affine.rgb, World(scene, cpu_options()).render(settings).rgb);
}

}  // namespace
}  // namespace scree::affine
