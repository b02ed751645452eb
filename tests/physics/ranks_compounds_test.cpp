// Compounds in scenes that several ranks simulate together: the answer of one rank, whoever owns the bodies whose parts touch.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "tests/physics/compound_scenes.h"
#include "tests/physics/joint_scenes.h"
#include "tests/physics/rank_runs.h"

namespace scree::physics {
namespace {

class CompoundsOnRanks : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Ranks, CompoundsOnRanks, testing::Values(3, 4),
                         testing::PrintToStringParamName());

/// Adds a compound whose mass is that of its parts.
BodyDescription& add_parts(Scene& scene, const Vec3d& position, std::vector<ShapePart> parts,
                           BodyKind kind = BodyKind::free) {
  return add_compound(scene, position, std::move(parts), kind, SharedMass::each_part);
}

/// Compounds of all sorts over a tank, with one that is fixed, one that moves as it is told, and a fixed ball.
Scene pile_on_a_table() {
  Scene scene = pile_of_compounds();
  scene.stepping.skin = 0.02;
  for (int k = 0; k < 9; ++k) {
    BodyDescription& body =
        add_parts(scene, {0.17 * (k % 3 - 1), 0.17 * (k / 3 - 1), 0.8}, two_halves(scene, 0.06));
    body.angular_velocity = {3, 0, 2};
  }
  add_parts(scene, {0, 0, 0.05}, cross_of_bars(0.1, 0.02), BodyKind::fixed);
  add_parts(scene, {0.15, 0, 0.03}, three_balls(0.03, 0.04), BodyKind::kinematic);
  add_sphere(scene, {-0.2, -0.2, 0.03}, 0.03, 1).kind = BodyKind::fixed;
  return scene;
}

double largest_speed(const WorldState& state) {
  double speed = 0;
  for (const Vec3d& v : state.at<Vec3d>("body/velocity")) speed = std::max(speed, norm(v));
  return speed;
}

TEST_P(CompoundsOnRanks, OneStepFromTheSameStateIsThatOfOneRank) {
  Scene scene = pile_on_a_table();
  const WorldState start = landed(scene, 0.25);
  for (const char* solver : {"apgd", "jacobi", "gauss_seidel_colored"}) {
    SCOPED_TRACE(solver);
    scene.solver.name = solver;
    solve_to(scene, 1e-12);
    const auto [one, more] =
        compared_step(GetParam(), scene, start, 1e-10 * std::max(1.0, largest_speed(start)));
    ASSERT_GT(one.contact_count, 60);
    EXPECT_TRUE(one.converged && more.converged)
        << one.residual_rms << " m/s after " << one.iterations << " iterations, "
        << more.residual_rms << " after " << more.iterations;
    EXPECT_NEAR(more.max_penetration, one.max_penetration, 1e-10 * one.max_penetration);
    EXPECT_NEAR(more.kinetic_energy, one.kinetic_energy, 1e-8 * one.kinetic_energy);
  }
}

/// A bar of balls that turns fast hits balls of other ranks far from its center, in the first step and later ones.
TEST_P(CompoundsOnRanks, AFastTurningBarMeetsWhatOthersOwn) {
  for (const int locks : {0, static_cast<int>(lock_z)}) {
    SCOPED_TRACE(locks);
    Scene scene = empty_scene(1e-3, 0.3);
    scene.gravity = {};
    solve_to(scene, 1e-12);
    scene.solver.max_iterations = 20000;
    std::vector<ShapePart> balls;
    for (int k = -20; k <= 20; ++k) balls.push_back(part(ball_of(0.02), {0.025 * k, 0, 0}));
    BodyDescription& bar = add_parts(scene, {0, 0, 0}, balls);
    bar.angular_velocity = {0, 0, 100};
    bar.locks = static_cast<std::uint8_t>(locks);
    // A ring of balls: the ends of the bar are at 50 m/s, 50 mm a step.
    for (int k = 0; k < 24; ++k) {
      const double angle = 2 * kPi * (k + 0.5) / 24;
      add_sphere(scene, {0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.01}, 0.015, 0.02);
    }
    const RunResult alone = run_on(1, scene, 12), shared = run_on(GetParam(), scene, 12);
    int contacts = 0;
    for (std::size_t k = 0; k < alone.reports.size(); ++k) {
      ASSERT_EQ(shared.reports[k].contact_count, alone.reports[k].contact_count) << "step " << k;
      contacts += static_cast<int>(alone.reports[k].contact_count);
    }
    EXPECT_GT(contacts, 4);
    EXPECT_LT(largest_difference(shared.states.velocity, alone.states.velocity), 1e-7);
    EXPECT_LT(norm(alone.states.angular_velocity[0]), 99);
  }
}

/// Crosses fly over the borders of ranks in a row, and hit each other in the end.
TEST_P(CompoundsOnRanks, FlyOverBordersAsOnOneRank) {
  Scene scene = empty_scene(1e-3, 0.3);
  scene.gravity = {};
  solve_to(scene, 1e-10);
  scene.solver.max_iterations = 2000;
  for (int k = 0; k < 12; ++k) {
    BodyDescription& body =
        add_parts(scene, {0.15 * k, 0.01 * (k % 3), 0}, cross_of_bars(0.07, 0.02));
    body.velocity = {k < 6 ? 12.0 : 9.0, 0, 0.1 * (k % 4)};
    body.angular_velocity = {0, 0, 5.0 * (k % 2)};
  }
  const RunResult alone = run_on(1, scene, 60), shared = run_on(GetParam(), scene, 60);
  const Momenta first = momenta_of(alone.states, scene), other = momenta_of(shared.states, scene);
  EXPECT_LT(norm(first.linear - other.linear), 1e-9);
  EXPECT_LT(norm(first.angular - other.angular), 1e-6);
  EXPECT_GT(shared.reports.back().contact_count + shared.reports[40].contact_count, 0);
  EXPECT_LT(largest_difference(shared.states.position, alone.states.position), 1e-6);
  EXPECT_GT(shared.states.position[0].x, 0.5);
}

/// A column of dumbbells, each on both balls of the one below, along which a clump flies: ghosts change whenever it comes near
/// others, and bodies move to other ranks. What is known of contacts stays: a solve that starts without the impulses at a border
/// takes as long as the first one.
TEST_P(CompoundsOnRanks, WarmStartsLastWhileGhostsChange) {
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {-kGravity, 0, 0};
  solve_to(scene, 1e-8);
  add_plane(scene, {1, 0, 0});
  for (int k = 0; k < 24; ++k)
    add_parts(scene, {0.02 + 0.04 * k, 0, 0},
              {part(ball_of(0.02), {0, -0.03, 0}), part(ball_of(0.02), {0, 0.03, 0})});
  add_parts(scene, {-1, 0.1, 0.1}, three_balls(0.02, 0.03)).velocity = {10, 0, 0};
  for (std::size_t k = 1; k < scene.bodies.size(); ++k)
    scene.bodies[k].locks = k + 1 < scene.bodies.size() ? lock_all & ~lock_x : 0;
  constexpr int kSteps = 400;
  const auto most_at_rest = [](const RunResult& run) {
    int most = 0;
    for (std::size_t k = 100; k < kSteps; ++k) most = std::max(most, run.reports[k].iterations);
    return most;
  };
  const RunResult one = run_on(1, scene, kSteps), more = run_on(GetParam(), scene, kSteps);
  EXPECT_LT(most_at_rest(more), 150);
  EXPECT_LT(most_at_rest(one), 150);
  EXPECT_GT(one.reports[0].iterations, 200) << "a cold start takes as few";
  EXPECT_GT(more.reports.back().ghost_share, 0);
}

TEST(CompoundsOnRanks, RepeatTheirBits) {
  Scene scene = pile_on_a_table();
  const RunResult first = run_on(3, scene, 150), second = run_on(3, scene, 150);
  EXPECT_TRUE(same_bits(first.states.position, second.states.position));
  EXPECT_TRUE(same_bits(first.states.velocity, second.states.velocity));
  EXPECT_EQ(first.reports.back().iterations, second.reports.back().iterations);
}

/// A pile that comes to rest in the tank, whoever owns which of its bodies meanwhile.
TEST(CompoundsOnRanks, APileComesToRest) {
  const Scene scene = pile_of_compounds();
  const RunResult run = run_on(3, scene, 1000);
  for (std::size_t i = 0; i < 36; ++i) {
    EXPECT_GT(run.states.position[i].z, 0.01) << i;
    EXPECT_LT(norm(run.states.velocity[i]), 0.03) << i;
  }
}

/// Impulses by the names of parts, with body A the one with the lower name.
std::map<std::tuple<int, int, std::uint64_t>, Vec3d> impulses_of(const WorldState& s) {
  std::map<std::tuple<int, int, std::uint64_t>, Vec3d> impulses;
  const auto& a = s.at<std::int32_t>("contact/body_a");
  const auto& b = s.at<std::int32_t>("contact/body_b");
  for (std::size_t c = 0; c < a.size(); ++c) {
    const bool is_turned = b[c] >= 0 && b[c] < a[c];
    const Vec3d gamma = s.at<Vec3d>("contact/impulse")[c];
    const std::tuple name(is_turned ? b[c] : a[c], is_turned ? a[c] : b[c],
                          s.at<std::uint64_t>("contact/feature")[c]);
    EXPECT_TRUE(impulses.emplace(name, is_turned ? -gamma : gamma).second) << a[c] << " " << b[c];
  }
  return impulses;
}

TEST(CompoundsOnRanks, CheckpointsServeAnyNumberOfRanks) {
  const Scene scene = pile_on_a_table();
  WorldState saved;
  BodyStates later;
  for (const int count : {1, 3}) {
    SCOPED_TRACE(count);
    on_ranks(count, scene, [&](World& world, Ranks& ranks) {
      for (int k = 0; k < 150; ++k) world.step();
      const WorldState state = world.save();
      for (int k = 0; k < 70; ++k) world.step();
      const BodyStates states = world.states();
      if (ranks.rank() == 0) saved = state, later = states;
    });
    on_ranks(count, scene, [&](World& world, Ranks& ranks) {
      world.restore(saved);
      for (int k = 0; k < 70; ++k) world.step();
      const BodyStates states = world.states();
      if (ranks.rank() > 0) return;
      EXPECT_TRUE(same_bits(states.position, later.position));
      EXPECT_TRUE(same_bits(states.velocity, later.velocity));
    });
    const auto impulses = impulses_of(saved);
    ASSERT_GT(impulses.size(), 60u);
    World alone = reference_world(scene);
    alone.restore(saved);
    EXPECT_TRUE(impulses_of(alone.save()) == impulses);
    const StepReport expected = alone.step();
    for (const int other : {1, 2, 5}) {
      SCOPED_TRACE(other);
      on_ranks(other, scene, [&](World& world, Ranks& ranks) {
        world.restore(saved);
        const WorldState again = world.save();
        EXPECT_TRUE(impulses_of(again) == impulses);
        const StepReport report = world.step();
        EXPECT_EQ(report.contact_count, expected.contact_count);
        EXPECT_NEAR(report.iterations, expected.iterations, 20) << "impulses were lost";
        const BodyStates states = world.states();
        if (ranks.rank() > 0) return;
        EXPECT_LT(largest_difference(states.velocity, alone.states().velocity), 1e-4);
      });
    }
  }
}

/// Clumps come while others fly over the borders: storage of bodies and of parts grows.
TEST_P(CompoundsOnRanks, JoinAndCrossTheBorders) {
  Scene scene = empty_scene(1e-3, 0.4);
  solve_to(scene, 1e-10);
  add_plane(scene);
  add_parts(scene, {0.3, 0, 0.02}, three_balls(0.02, 0.03), BodyKind::fixed);
  add_parts(scene, {0, 0.3, 0.01}, three_balls(0.01, 0.015));
  add_sphere(scene, {0.6, 0.3, 0.01}, 0.01, 0.01);
  for (int batch = 0; batch < 8; ++batch) {
    Insertion insertion;
    insertion.time = 0.04 * batch;
    for (int k = 0; k < 3; ++k) {
      BodyDescription body;
      body.position = {0.05, 0.06 * k - 0.06, 0.3};
      set_compound(scene, body, three_balls(0.01, 0.015), SharedMass::each_part);
      set_mass_from_density(body, 1000);
      body.velocity = {2, 0, 0};
      insertion.bodies.push_back(body);
    }
    scene.insertions.push_back(insertion);
  }
  const RunResult one = run_on(1, scene, 350), more = run_on(GetParam(), scene, 350);
  ASSERT_EQ(more.states.position.size(), 28u);
  EXPECT_EQ(more.reports.back().body_count, 26);
  EXPECT_NEAR(more.reports[200].kinetic_energy, one.reports[200].kinetic_energy,
              1e-8 * one.reports[200].kinetic_energy);
  for (std::size_t i = 2; i < 28; ++i) EXPECT_GT(more.states.position[i].z, 0.0095) << i;
}

TEST_P(CompoundsOnRanks, MeetAcrossPeriodicSides) {
  Scene scene = empty_scene(1e-3, 0.3);
  add_plane(scene);
  scene.periodicity.periodic = {true, true, false};
  scene.periodicity.lower = {0, 0, 0};
  scene.periodicity.upper = {0.4, 0.3, 0};
  for (int k = 0; k < 48; ++k) {
    BodyDescription& body =
        add_parts(scene, {0.1 * (k % 4) + 0.01, 0.1 * (k / 4 % 3) + 0.02, 0.03 + 0.06 * (k / 12)},
                  k % 2 == 0 ? three_balls(0.02, 0.03) : cross_of_bars(0.045, 0.015));
    body.velocity = {0.5, 0.2, 0};
  }
  const WorldState start = landed(scene, 0.2);
  solve_to(scene, 1e-13);
  scene.solver.max_iterations = 200000;
  const auto [one, more] = compared_step(GetParam(), scene, start, 1e-10);
  ASSERT_GT(one.contact_count, 60);
}

TEST_P(CompoundsOnRanks, JointsHoldThemAcrossBorders) {
  Scene scene = empty_scene(1e-3, 0.3);
  add_plane(scene);
  for (int k = 0; k < 12; ++k) add_parts(scene, {0.12 * k, 0, 0.1}, cross_of_bars(0.05, 0.01));
  for (int k = 1; k < 12; ++k)
    scene.joints.push_back(joint_of(k % 2 == 0 ? JointKind::ball : JointKind::hinge, k, k + 1,
                                    {0.12 * k - 0.06, 0, 0.1}, {0, 1, 0}));
  const WorldState start = landed(scene, 0.15);
  solve_to(scene, 1e-13);
  scene.solver.max_iterations = 200000;
  const auto [one, more] = compared_step(GetParam(), scene, start, 1e-9);
  ASSERT_GT(one.contact_count, 10);
  EXPECT_NEAR(more.max_joint_error, one.max_joint_error, 1e-12 + 1e-9 * one.max_joint_error);
}

TEST_P(CompoundsOnRanks, BounceOffEachOther) {
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  scene.materials[0].restitution = 0.7;
  solve_to(scene, 1e-11);
  scene.solver.max_iterations = 20000;
  for (int k = 0; k < 64; ++k) {
    BodyDescription& body =
        add_parts(scene, {0.1 * (k % 4), 0.1 * (k / 4 % 4), 0.1 * (k / 16)},
                  k % 3 == 0 ? cross_of_bars(0.045, 0.012) : three_balls(0.02, 0.025));
    body.velocity = {k % 2 == 0 ? 2.0 : -2.0, k % 3 == 0 ? 1.0 : -1.0, 0.2 * (k % 5) - 0.4};
  }
  const RunResult one = run_on(1, scene, 25), more = run_on(GetParam(), scene, 25);
  EXPECT_NEAR(more.reports[10].kinetic_energy, one.reports[10].kinetic_energy,
              1e-5 * one.reports[10].kinetic_energy);
  EXPECT_LT(one.reports.back().kinetic_energy, 0.98 * one.reports[0].kinetic_energy);
}

TEST_P(CompoundsOnRanks, PicturesForcesAndOverlapsAreThoseOfAll) {
  Scene scene = pile_on_a_table();
  PictureSettings picture;
  picture.width = 160;
  picture.height = 120;
  World alone = reference_world(scene);
  const Image expected = alone.render(picture);
  Scene touching = empty_scene(1e-3, 0);
  for (int k = 0; k < 12; ++k) add_parts(touching, {0.079 * k, 0, 0}, three_balls(0.02, 0.02));
  const std::size_t overlaps = reference_world(touching).overlaps().size();
  EXPECT_EQ(overlaps, 11u);
  on_ranks(GetParam(), touching, [&](World& world, Ranks& ranks) {
    const std::size_t found = world.overlaps().size();
    if (ranks.rank() == 0) {
      EXPECT_EQ(found, overlaps);
    }
  });
  std::vector<StepReport> undisturbed = run_on(GetParam(), scene, 150).reports;
  on_ranks(GetParam(), scene, [&](World& world, Ranks& ranks) {
    const Image image = world.render(picture);
    if (ranks.rank() == 0) {
      EXPECT_EQ(image.rgb, expected.rgb);
    }
    world.track_forces();
    StepReport report;
    for (int k = 0; k < 150; ++k) {
      if (k == 100) world.render(picture);
      report = world.step();
      EXPECT_NEAR(report.iterations, undisturbed[static_cast<std::size_t>(k)].iterations,
                  k < 101 ? 0 : 100)
          << k;
    }
    const std::size_t contacts = world.contacts().size();
    if (ranks.rank() == 0) {
      EXPECT_EQ(contacts, static_cast<std::size_t>(report.contact_count));
    }
    EXPECT_GT(norm(world.take_forces().on_bodies[0].force), 0.1);
  });
}

}  // namespace
}  // namespace scree::physics
