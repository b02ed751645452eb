// Scenes that several ranks simulate together: the answer of one rank, whoever owns the bodies. Ranks are threads here.

#include "kernels/backend/ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <set>

#include "host/error.h"
#include "tests/physics/rank_runs.h"

namespace scree::physics {
namespace {

/// A loose block of spheres of two sizes that falls on a floor.
Scene falling_block(int count = 300) {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_lattice(scene, count, 8, 6, {0.02, 0.02, 0.011}, 0.022, 0.01, 2500, 5);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i)
    if (i % 3 == 0) {
      scene.bodies[i].shape.radius = 0.007;
      set_mass_from_density(scene.bodies[i], 2500);
    }
  return scene;
}

class OnRanks : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Ranks, OnRanks, testing::Values(2, 3, 4),
                         testing::PrintToStringParamName());

TEST_P(OnRanks, OneStepFromTheSameStateIsThatOfOneRank) {
  Scene scene = falling_block();
  solve_to(scene, 1e-13);
  const WorldState start = landed(scene, 0.25);
  double speed = 0;
  for (const Vec3d& v : start.at<Vec3d>("body/velocity")) speed = std::max(speed, norm(v));
  const auto [one, more] = compared_step(GetParam(), scene, start, 1e-10 * speed);
  ASSERT_GT(one.contact_count, 300);
  EXPECT_EQ(more.body_count, one.body_count);
  EXPECT_TRUE(more.converged);
  EXPECT_NEAR(more.max_penetration, one.max_penetration, 1e-12 * one.max_penetration);
  EXPECT_NEAR(more.kinetic_energy, one.kinetic_energy, 1e-8 * one.kinetic_energy);
}

TEST(RanksOfAScene, RepeatsItsBits) {
  Scene scene = falling_block();
  scene.solver = SolverSettings{};
  const RunResult first = run_on(3, scene, 100), second = run_on(3, scene, 100);
  EXPECT_TRUE(same_bits(first.states.position, second.states.position));
  EXPECT_TRUE(same_bits(first.states.velocity, second.states.velocity));
  EXPECT_EQ(first.reports.back().iterations, second.reports.back().iterations);
}

TEST(RanksOfAScene, FloatsStayTogetherInALongRun) {
  Scene scene = falling_block();
  scene.solver = SolverSettings{};
  const RunResult one = run_on(1, scene, 300, Precision::single_precision);
  const RunResult more = run_on(3, scene, 300, Precision::single_precision);
  // Chaotic in the details: heights on the whole are alike. From starts that differ by 1e-7 m they spread by 0.5 % on one
  // rank and on three.
  const auto mean_height = [](const RunResult& run) {
    double sum = 0;
    for (std::size_t i = 1; i < run.states.position.size(); ++i) sum += run.states.position[i].z;
    return sum / static_cast<double>(run.states.position.size() - 1);
  };
  EXPECT_NEAR(mean_height(more), mean_height(one), 0.03 * mean_height(one));
  for (std::size_t i = 1; i < more.states.position.size(); ++i)
    EXPECT_GT(more.states.position[i].z, 0.0065) << "body " << i;
}

/// A ball rolls from one end of a row of resting balls' space to the other, so that its owner changes.
TEST_P(OnRanks, BallRollsOverEveryBorder) {
  Scene scene = empty_scene(1e-3, 0.5);
  add_plane(scene);
  for (int k = 0; k < 8; ++k) add_sphere(scene, {0.1 * k, 0.2, 0.01}, 0.01, 0.01);
  BodyDescription& ball = add_sphere(scene, {0, 0, 0.01}, 0.01, 0.01);
  ball.velocity = {1, 0, 0};
  ball.angular_velocity = {0, 100, 0};
  const int id = last_id(scene);
  const RunResult one = run_on(1, scene, 700), more = run_on(GetParam(), scene, 700);
  const auto i = static_cast<std::size_t>(id);
  EXPECT_NEAR(more.states.position[i].x, 0.7, 1e-6);
  EXPECT_NEAR(more.states.position[i].x, one.states.position[i].x, 1e-10);
  EXPECT_NEAR(more.states.angular_velocity[i].y, 100, 1e-4);
}

TEST_P(OnRanks, MomentumIsKeptAcrossBorders) {
  Scene scene = empty_scene(1e-3, 0.3);
  scene.gravity = {};
  add_lattice(scene, 216, 6, 6, {-0.05, -0.05, -0.05}, 0.0202, 0.01, 2500, 3);
  for (BodyDescription& body : scene.bodies) body.velocity = -4 * body.position;
  Vec3d before, after;
  for (const BodyDescription& body : scene.bodies) before += body.mass * body.velocity;
  const RunResult run = run_on(GetParam(), scene, 60);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    after += scene.bodies[i].mass * run.states.velocity[i];
  double scale = 0;
  for (const BodyDescription& body : scene.bodies) scale += body.mass * norm(body.velocity);
  EXPECT_GT(run.contacts.size(), 300u);
  EXPECT_LT(norm(after - before), 1e-10 * scale);
}

/// Four balls carry a fifth over the place where four ranks meet.
TEST_P(OnRanks, PyramidStandsOnABorder) {
  Scene scene = empty_scene(1e-3, 0.6);
  add_plane(scene);
  const double r = 0.01, m = 0.01;
  for (const double x : {-r, r})
    for (const double y : {-r, r}) add_sphere(scene, {x, y, r}, r, m);
  add_sphere(scene, {0, 0, r + r * std::sqrt(2.0)}, r, m);
  const RunResult run = run_on(GetParam(), scene, 300);
  EXPECT_NEAR(run.states.position[5].z, r + r * std::sqrt(2.0), 1e-4);
  EXPECT_LT(norm(run.states.velocity[5]), 1e-6);
  double lifted = 0;
  for (const ContactRecord& c : run.contacts)
    if (c.body_a == 0 || c.body_b == 0) lifted += std::abs(dot(c.impulse, c.normal));
  EXPECT_NEAR(lifted, 5 * m * kGravity * scene.stepping.time_step, 1e-7);
}

TEST_P(OnRanks, PeriodicSidesMeetOtherRanks) {
  Scene scene = empty_scene(1e-3, 0.3);
  add_plane(scene);
  scene.periodicity.periodic = {true, true, false};
  scene.periodicity.lower = {0, 0, 0};
  scene.periodicity.upper = {0.16, 0.12, 0};
  add_lattice(scene, 240, 8, 6, {0.01, 0.01, 0.0105}, 0.02, 0.0095, 2500, 9);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) scene.bodies[i].velocity = {0.5, 0.2, 0};
  compared_step(GetParam(), scene, landed(scene, 0.2), 1e-8);
}

/// A batch of balls enters every 20 ms and crosses the space of all ranks.
TEST_P(OnRanks, JetCrossesTheBorders) {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.01}, 0.01, 0.01);
  add_sphere(scene, {0.6, 0, 0.01}, 0.01, 0.01);
  for (int batch = 0; batch < 10; ++batch) {
    std::vector<BodyDescription> balls;
    for (int k = 0; k < 4; ++k) {
      balls.push_back(sphere({0.05, 0.03 * k - 0.045, 0.3}, 0.01, 0.01));
      balls.back().velocity = {2, 0, 0};
    }
    scene.insertions.push_back({0.02 * batch, balls});
  }
  const RunResult one = run_on(1, scene, 400), more = run_on(GetParam(), scene, 400);
  ASSERT_EQ(more.states.position.size(), 43u);
  EXPECT_EQ(more.reports.back().body_count, 42);
  // Until they land nothing is chaotic.
  EXPECT_NEAR(more.reports[200].kinetic_energy, one.reports[200].kinetic_energy,
              1e-9 * one.reports[200].kinetic_energy);
  for (std::size_t i = 1; i < 43; ++i) EXPECT_GT(more.states.position[i].z, 0.0099) << "ball " << i;
}

/// Storage of a rank grows when its first ghosts come: walls get other places, and what is known of contacts stays.
TEST(RanksOfAScene, RoomForGhostsKeepsContacts) {
  Scene scene = empty_scene(1e-3, 0);
  solve_to(scene, 1e-10);
  add_wall_box(scene, {1, 1, -0.05}, {3, 3, 0.05});
  // Two rows rest, and two come near. They pass the cut between them after one look whether bodies left the space of their
  // rank, and get near before the next.
  add_lattice(scene, 200, 100, 2, {0.01, 0.0001, 0.01}, 0.0201, 0.01, 2500, 3);
  const std::size_t first = scene.bodies.size();
  add_lattice(scene, 200, 100, 2, {0.01, 2.2402, 0.01}, 0.0201, 0.01, 2500, 3);
  for (std::size_t i = first; i < scene.bodies.size(); ++i) scene.bodies[i].velocity.y = -68.7;
  std::vector<StepReport> one, two;
  for (std::vector<StepReport>* reports : {&one, &two})
    on_ranks(reports == &one ? 1 : 2, scene, [&](World& world, Ranks& ranks) {
      for (int k = 0; k < 32; ++k) {
        const StepReport report = world.step();
        if (ranks.rank() == 0) reports->push_back(report);
      }
    });
  EXPECT_EQ(two[25].ghost_share, 0);
  EXPECT_GT(two.back().ghost_share, 0.2);
  ASSERT_GT(two.back().contact_count, 390);
  for (std::size_t k = 20; k < two.size(); ++k)
    EXPECT_LE(two[k].iterations, one[k].iterations + 3) << "step " << k;
}

/// A rank has room for its own bodies and ghosts, not for all.
TEST(RanksOfAScene, MemoryIsDivided) {
  Scene scene = empty_scene(1e-3, 0.4);
  scene.solver = SolverSettings{};
  add_plane(scene);
  add_lattice(scene, 8000, 200, 4, {0.0101, 0.0101, 0.0101}, 0.0202, 0.01, 2500, 3);
  std::size_t alone = 0, most = 0;
  for (const int count : {1, 4})
    on_ranks(count, scene, [&](World& world, Ranks& ranks) {
      for (int k = 0; k < 30; ++k) world.step();
      for (const std::size_t of_rank : gather(ranks, world.peak_memory())) {
        std::size_t& largest = count == 1 ? alone : most;
        if (ranks.rank() == 0) largest = std::max(largest, of_rank);
      }
    });
  RecordProperty("share_of_memory",
                 std::to_string(static_cast<double>(most) / static_cast<double>(alone)));
  EXPECT_LT(static_cast<double>(most), 0.3 * static_cast<double>(alone));
}

TEST_P(OnRanks, MoreRanksThanBodies) {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_sphere(scene, {0, 0, 0.01}, 0.01, 0.01);
  const RunResult run = run_on(GetParam(), scene, 100);
  EXPECT_NEAR(run.states.position[1].z, 0.01, 1e-6);
  EXPECT_EQ(run.reports.back().contact_count, 1);
  EXPECT_EQ(run.reports.back().residual_max_body_a + run.reports.back().residual_max_body_b, 1);
}

TEST_P(OnRanks, NoBodiesUntilOneComes) {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  scene.insertions.push_back({0.002, {sphere({0, 0, 0.01}, 0.01, 0.01)}});
  const RunResult run = run_on(GetParam(), scene, 5);
  EXPECT_EQ(run.reports[1].contact_count, 0);
  EXPECT_EQ(run.reports[1].body_count, 0);
  EXPECT_EQ(run.reports[4].contact_count, 1);
}

TEST(RanksOfAScene, CheckpointsServeAnyNumberOfRanks) {
  Scene scene = falling_block(120);
  WorldState saved;
  BodyStates later;
  on_ranks(3, scene, [&](World& world, Ranks& ranks) {
    for (int k = 0; k < 120; ++k) world.step();
    const WorldState state = world.save();
    for (int k = 0; k < 40; ++k) world.step();
    const BodyStates states = world.states();
    if (ranks.rank() == 0) saved = state, later = states;
  });
  // The same bits on as many ranks.
  on_ranks(3, scene, [&](World& world, Ranks& ranks) {
    world.restore(saved);
    EXPECT_EQ(world.steps_done(), 120);
    for (int k = 0; k < 40; ++k) world.step();
    const BodyStates states = world.states();
    if (ranks.rank() == 0) {
      EXPECT_TRUE(same_bits(states.position, later.position));
      EXPECT_TRUE(same_bits(states.velocity, later.velocity));
    }
  });
  // One step of any other number.
  for (const int other : {1, 2, 5}) {
    BodyStates step_later;
    on_ranks(other, scene, [&](World& world, Ranks& ranks) {
      world.restore(saved);
      world.step();
      const BodyStates states = world.states();
      if (ranks.rank() == 0) step_later = states;
    });
    World alone = reference_world(scene);
    alone.restore(saved);
    alone.step();
    EXPECT_LT(largest_difference(step_later.velocity, alone.states().velocity), 1e-8) << other;
  }
}

TEST(RanksOfAScene, ForcesOnWallsAreThoseOfAllRanks) {
  Scene scene = falling_block(60);
  scene.solver = SolverSettings{};
  double mass = 0;
  for (const BodyDescription& body : scene.bodies)
    if (body.kind == BodyKind::free) mass += body.mass;
  on_ranks(3, scene, [&](World& world, Ranks&) {
    world.track_forces();
    for (int k = 0; k < 500; ++k) world.step();
    world.take_forces();
    for (int k = 0; k < 100; ++k) world.step();
    const MeanForces means = world.take_forces();
    ASSERT_EQ(means.on_bodies.size(), 1u);
    EXPECT_NEAR(means.on_bodies[0].force.z, -mass * kGravity, 0.01 * mass * kGravity);
    EXPECT_NEAR(world.force_on(0).force.z, -mass * kGravity, 0.05 * mass * kGravity);
  });
}

/// Contacts that two ranks list are in a state once, whatever was called since the last step.
TEST(RanksOfAScene, StatesHoldEachContactOnce) {
  Scene scene = falling_block(120);
  scene.output.contact_frames = true;
  PictureSettings picture;
  picture.width = picture.height = 64;
  on_ranks(3, scene, [&](World& world, Ranks& ranks) {
    for (int k = 0; k < 120; ++k) world.step();
    const std::size_t contacts = world.contacts().size();
    world.render(picture);
    const WorldState state = world.save(), again = world.save();
    for (const WorldState* s : {&state, &again}) {
      const auto& a = s->at<std::int32_t>("contact/body_a");
      const auto& b = s->at<std::int32_t>("contact/body_b");
      std::set<std::pair<int, int>> pairs;
      for (std::size_t c = 0; c < a.size(); ++c)
        EXPECT_TRUE(pairs.insert({std::min(a[c], b[c]), std::max(a[c], b[c])}).second || b[c] < 0)
            << a[c] << " " << b[c];
    }
    if (ranks.rank() == 0) {
      EXPECT_GT(contacts, 100u);
      EXPECT_EQ(state.at<std::int32_t>("contact/body_a").size(), contacts);
      EXPECT_EQ(world.contacts().size(), contacts);
    }
    WorldState bad = state;
    bad.at<std::int32_t>("body/id")[0] = bad.at<std::int32_t>("body/id")[1];
    EXPECT_THROW(world.restore(bad), InputError);
    bad = state;
    bad.at<Vec3d>("body/velocity").pop_back();
    EXPECT_THROW(world.restore(bad), InputError);
  });
}

TEST_P(OnRanks, PicturesShowAllBodies) {
  Scene scene = falling_block(60);
  PictureSettings picture;
  picture.width = 160;
  picture.height = 120;
  World alone = reference_world(scene);
  const Image expected = alone.render(picture);
  on_ranks(GetParam(), scene, [&](World& world, Ranks& ranks) {
    const Image image = world.render(picture);
    if (ranks.rank() == 0) {
      EXPECT_EQ(image.rgb, expected.rgb);
    }
    world.step();
    EXPECT_EQ(world.body_count(), 61);
  });
}

TEST_P(OnRanks, OverlapsAreFoundOnce) {
  Scene scene = empty_scene(1e-3, 0.4);
  for (int k = 0; k < 20; ++k) add_sphere(scene, {0.019 * k, 0, 0}, 0.01, 0.01);
  on_ranks(GetParam(), scene, [&](World& world, Ranks& ranks) {
    const std::vector<ContactRecord> found = world.overlaps();
    if (ranks.rank() == 0) {
      EXPECT_EQ(found.size(), 19u);
    }
  });
}

/// Boxes and spheres: pair functions take two bodies in the order of their ids, on every rank.
TEST(RanksOfAScene, ShapesMeetAcrossBorders) {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_boxes_and_spheres(scene, 60, 5, 3);
  compared_step(3, scene, landed(scene, 0.25), 1e-8);
}

/// Balls in free space, side^3 of them, that fly into each other.
Scene flying_balls(int side, double friction, double restitution) {
  Scene scene = empty_scene(1e-3, friction);
  scene.gravity = {};
  scene.materials[0].restitution = restitution;
  add_lattice(scene, side * side * side, side, side, {0, 0, 0}, 0.025, 0.01, 2500, 4);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    scene.bodies[i].velocity = {i % 2 == 0 ? 0.4 : -0.4, i % 3 == 0 ? 0.3 : -0.2,
                                0.1 * (i % 5) - 0.2};
  return scene;
}

/// What Poisson's law keeps of the kinetic energy of elastic balls does not depend on borders.
TEST_P(OnRanks, ImpactsGoThroughBorders) {
  const Scene scene = flying_balls(5, 0, 1);
  const RunResult one = run_on(1, scene, 100), more = run_on(GetParam(), scene, 100);
  EXPECT_NEAR(more.reports[20].kinetic_energy, one.reports[20].kinetic_energy,
              1e-6 * one.reports[20].kinetic_energy);
  EXPECT_LT(more.reports.back().kinetic_energy, 1.0001 * one.reports[0].kinetic_energy);
  EXPECT_GT(more.reports.back().kinetic_energy, 0.99 * one.reports[0].kinetic_energy);
}

/// The same with exact friction, whose corrections go on until all ranks have enough; one of them has no impacts.
TEST_P(OnRanks, ExactImpactsGoThroughBorders) {
  Scene scene = flying_balls(4, 0.3, 0.5);
  scene.solver.exact_coulomb = true;
  for (int k = 0; k < 64; ++k) add_sphere(scene, {1 + 0.05 * k, 0, 0}, 0.01, 0.01);
  const RunResult one = run_on(1, scene, 40), more = run_on(GetParam(), scene, 40);
  EXPECT_NEAR(more.reports[20].kinetic_energy, one.reports[20].kinetic_energy,
              1e-5 * one.reports[20].kinetic_energy);
  EXPECT_LT(one.reports.back().kinetic_energy, 0.95 * one.reports[0].kinetic_energy);
  EXPECT_NEAR(more.reports.back().kinetic_energy, one.reports.back().kinetic_energy,
              0.02 * one.reports.back().kinetic_energy);
}

TEST_P(OnRanks, ColoredGaussSeidelAgreesToo) {
  Scene scene = falling_block(150);
  const WorldState start = landed(scene, 0.25);
  scene.solver.name = "gauss_seidel_colored";
  solve_to(scene, 1e-11);
  scene.solver.max_iterations = 200000;
  const auto [one, more] = compared_step(GetParam(), scene, start, 1e-8);
  EXPECT_TRUE(one.converged && more.converged);
  // Contacts at borders take smaller steps.
  EXPECT_LT(more.iterations, 4 * one.iterations);
}

TEST(RanksOfAScene, JacobiAgreesToo) {
  Scene scene = falling_block(60);
  scene.solver.name = "jacobi";
  solve_to(scene, 1e-9);
  scene.solver.max_iterations = 200000;
  const auto [one, three] = compared_step(3, scene, landed(scene, 0.05), 1e-10);
  EXPECT_EQ(three.iterations, one.iterations);
}

/// By steps of the exact law, by steps that follow the shift, and by the fixed point around another solver.
TEST(RanksOfAScene, ExactFrictionAgreesToo) {
  for (const auto& [solver, friction] :
       {std::pair{"apgd", 0.4}, std::pair{"apgd", 3.0}, std::pair{"jacobi", 0.4}}) {
    SCOPED_TRACE(std::string(solver) + " " + std::to_string(friction));
    Scene scene = falling_block(60);
    const WorldState start = landed(scene, 0.12);
    scene.materials[0].friction = friction;
    scene.solver.name = solver;
    scene.solver.exact_coulomb = true;
    solve_to(scene, 1e-11);
    scene.solver.max_iterations = 100000;
    const auto [one, three] = compared_step(3, scene, start, 1e-8);
    EXPECT_TRUE(one.converged);
    EXPECT_TRUE(three.converged);
    EXPECT_GT(one.contact_count, 40);
  }
}

/// A column as high as wide falls apart: run-out and height do not depend on the ranks.
TEST(RanksOfAScene, ColumnCollapsesAlikeOnFourRanks) {
  Scene scene = empty_scene(5e-4, 0.5);
  scene.solver = SolverSettings{};
  add_plane(scene);
  const double r = 0.005;
  add_lattice(scene, 6 * 6 * 8, 6, 6, {-5 * r, -5 * r, r}, 2.02 * r, r, 2500, 11);
  const auto radius_of_half = [](const RunResult& run) {
    std::vector<double> radii;
    for (std::size_t i = 1; i < run.states.position.size(); ++i)
      radii.push_back(std::hypot(run.states.position[i].x, run.states.position[i].y));
    std::sort(radii.begin(), radii.end());
    return radii[radii.size() / 2];
  };
  const RunResult one = run_on(1, scene, 400, Precision::single_precision);
  const RunResult four = run_on(4, scene, 400, Precision::single_precision);
  EXPECT_NEAR(radius_of_half(four), radius_of_half(one), 0.05 * radius_of_half(one));
  EXPECT_GT(radius_of_half(one), 5 * r);
  EXPECT_TRUE(four.reports.back().converged);
}

TEST(RanksOfAScene, WhatOneRankAloneSimulatesIsRefusedByName) {
  const auto message = [](const Scene& scene) {
    std::string text;
    try {
      on_ranks(2, scene, [](World&, Ranks&) {});
    } catch (const InputError& error) {
      text = error.what();
    }
    return text;
  };
  Scene other = falling_block(10);
  other.solver.name = "schwarz";
  EXPECT_NE(message(other).find("\"apgd\", \"jacobi\", \"gauss_seidel_colored\""),
            std::string::npos)
      << message(other);
}

TEST(RanksOfAScene, AStateThatIsNotFiniteIsNamedOnce) {
  Scene scene = falling_block(20);
  scene.bodies[7].position = {9.9995e14, 0, 0.1};
  scene.bodies[7].velocity = {9e14, 0, 0};
  try {
    on_ranks(3, scene, [](World& world, Ranks&) {
      for (int k = 0; k < 5; ++k) world.step();
    });
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("body 7"), std::string::npos) << error.what();
  }
}

/// Rank 0 calls; the others follow.
TEST(LedRanks, FollowRankZero) {
  const Scene scene = falling_block(60);
  World alone = reference_world(scene);
  StepReport expected;
  for (int k = 0; k < 5; ++k) expected = alone.step();
  run_thread_ranks(3, [&](const std::shared_ptr<Ranks>& ranks) {
    WorldOptions options = cpu_options();
    options.ranks = ranks;
    options.rank_calls = RankCalls::led;
    if (ranks->rank() > 0) return follow_worlds(scene, options);
    {
      World world(scene, options);
      WorldState state;
      for (int k = 0; k < 5; ++k) {
        if (k == 3) state = world.save();
        EXPECT_EQ(world.step().step, k + 1);
      }
      EXPECT_NEAR(norm(world.states().position[30] - alone.states().position[30]), 0, 1e-9);
      world.restore(state);
      EXPECT_EQ(world.steps_done(), 3);
      EXPECT_THROW(world.force_on(0), InputError);
      world.step();
    }
    release_followers(*ranks);
  });
}

}  // namespace
}  // namespace scree::physics
