// Joints in scenes that several ranks simulate together: the answer of one rank, whoever owns their bodies.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/error.h"
#include "tests/physics/joint_scenes.h"
#include "tests/physics/rank_runs.h"

namespace scree::physics {
namespace {

class JointsOnRanks : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Ranks, JointsOnRanks, testing::Values(2, 3, 4),
                         testing::PrintToStringParamName());

TEST_P(JointsOnRanks, OneStepFromTheSameStateIsThatOfOneRank) {
  Scene scene = row_of_joints();
  const WorldState start = landed(scene, 0.12);
  for (const char* solver : {"apgd", "jacobi", "gauss_seidel_colored"}) {
    SCOPED_TRACE(solver);
    scene.solver.name = solver;
    solve_to(scene, 1e-13);
    scene.solver.max_iterations = 200000;
    const auto [one, more] = compared_step(GetParam(), scene, start, 1e-9);
    ASSERT_GT(one.contact_count, 20);
    EXPECT_TRUE(more.converged && one.converged) << solver;
    EXPECT_NEAR(more.max_joint_error, one.max_joint_error, 1e-12 + 1e-9 * one.max_joint_error);
    EXPECT_EQ(more.max_joint_error_joint, one.max_joint_error_joint);
    EXPECT_NEAR(more.kinetic_energy, one.kinetic_energy, 1e-6 * one.kinetic_energy);
  }
}

TEST_P(JointsOnRanks, ImpactsOfAStepAreThoseOfOneRank) {
  Scene scene = row_of_joints(20, 0.5);
  solve_to(scene, 1e-10);
  scene.solver.max_iterations = 200000;
  World falls = reference_world(scene);
  int compared = 0;
  for (int k = 0; k < 100 && compared < 3; ++k) {
    const WorldState before = falls.save();
    falls.step();
    const WorldState after = falls.save();
    if (k % 20 != 0 && !after.has("joint/in_impacts")) continue;
    const auto [one, more] = compared_step(GetParam(), scene, before, 1e-6);
    EXPECT_TRUE(more.converged && one.converged) << k;
    if (!after.has("joint/in_impacts")) continue;
    ++compared;
    std::vector<JointRecord> joints;
    on_ranks(GetParam(), scene, [&](World& world, Ranks& ranks) {
      world.restore(before);
      world.step();
      std::vector<JointRecord> known = world.joints();
      if (ranks.rank() == 0) joints = std::move(known);
    });
    const std::vector<JointRecord> expected = falls.joints();
    for (std::size_t j = 0; j < joints.size(); ++j)
      EXPECT_LT(norm(joints[j].force - expected[j].force), 1e-5) << j;
  }
  EXPECT_EQ(compared, 3);
}

/// A chain of rods in space that turns and flies over the borders of ranks.
Scene flying_chain(int links) {
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  solve_to(scene, 1e-9);
  scene.solver.max_iterations = 20000;
  for (int k = 0; k < links; ++k) {
    BodyDescription& rod =
        add_box(scene, {0.1 * k, 0, 0}, {0.045, 0.01, 0.01}, k % 2 == 0 ? 0.1 : 0.3);
    rod.velocity = {9, 0.9 * k, 0.1 * (k % 4)};
    rod.angular_velocity = {0, 0, 2};
    if (k > 0) scene.joints.push_back(joint_of(JointKind::ball, k, k - 1, {0.1 * k - 0.05, 0, 0}));
  }
  return scene;
}

TEST_P(JointsOnRanks, AChainFliesOverBordersAsOnOneRank) {
  const Scene scene = flying_chain(16);
  constexpr int kSteps = 100;
  const RunResult alone = run_on(1, scene, kSteps), shared = run_on(GetParam(), scene, kSteps);
  const Momenta first = momenta_of(alone.states, scene), other = momenta_of(shared.states, scene);
  EXPECT_LT(norm(first.linear - other.linear), 1e-9);
  EXPECT_LT(norm(first.angular - other.angular), 1e-7);
  EXPECT_LT(largest_difference(shared.states.position, alone.states.position), 1e-5);
  for (const StepReport& report : shared.reports) {
    ASSERT_TRUE(report.converged);
    ASSERT_LT(report.max_joint_error, 1e-6);
  }
  EXPECT_GT(norm(alone.states.position[0] - scene.bodies[0].position), 0.8);
}

// Two balls on a rod of a meter, with the balls of other ranks between them: each owner must know the other's.
TEST(JointsOnRanks, PartnersAreKnownHoweverFarTheyAre) {
  Scene scene = empty_scene(1e-3, 0);
  solve_to(scene, 1e-12);
  add_sphere(scene, {0, 0, 0}, 0.02, 1).velocity = {0, 1, 0};
  add_sphere(scene, {1, 0, 0}, 0.02, 3);
  for (int k = 0; k < 30; ++k) add_sphere(scene, {0.03 * k + 0.05, 2, 0}, 0.01, 1);
  scene.joints.push_back(line_of(JointKind::distance, 1, 0, {1, 0, 0}, {}));
  const RunResult alone = run_on(1, scene, 300), shared = run_on(4, scene, 300);
  EXPECT_LT(largest_difference(shared.states.position, alone.states.position), 1e-9);
  EXPECT_NEAR(norm(shared.states.position[0] - shared.states.position[1]), 1, 1e-6);
}

TEST(JointsOnRanks, RepeatTheirBitsAndGoOnFromCheckpoints) {
  Scene scene = row_of_joints();
  scene.solver.stop = StopRule();
  WorldState saved;
  BodyStates later;
  std::vector<JointRecord> records;
  on_ranks(3, scene, [&](World& world, Ranks& ranks) {
    for (int k = 0; k < 120; ++k) world.step();
    const WorldState state = world.save();
    for (int k = 0; k < 40; ++k) world.step();
    const BodyStates states = world.states();
    const std::vector<JointRecord> joints = world.joints();
    if (ranks.rank() == 0) saved = state, later = states, records = joints;
  });
  on_ranks(3, scene, [&](World& world, Ranks& ranks) {
    world.restore(saved);
    for (int k = 0; k < 40; ++k) world.step();
    const BodyStates states = world.states();
    const std::vector<JointRecord> joints = world.joints();
    ASSERT_EQ(joints.size(), records.size());
    for (std::size_t j = 0; j < joints.size(); ++j) {
      EXPECT_EQ(joints[j].force, records[j].force) << j;
      EXPECT_EQ(joints[j].position, records[j].position) << j;
    }
    if (ranks.rank() > 0) return;
    EXPECT_TRUE(same_bits(states.position, later.position));
    EXPECT_TRUE(same_bits(states.velocity, later.velocity));
  });
  Scene tight = scene;
  solve_to(tight, 1e-11);
  for (const int other : {1, 2, 5}) {
    World alone = reference_world(tight);
    alone.restore(saved);
    alone.step();
    const std::vector<JointRecord> expected = alone.joints();
    on_ranks(other, tight, [&](World& world, Ranks&) {
      world.restore(saved);
      world.step();
      const std::vector<JointRecord> joints = world.joints();
      for (std::size_t j = 0; j < joints.size(); ++j) {
        EXPECT_LT(norm(joints[j].force - expected[j].force), 1e-8) << j;
        EXPECT_LT(norm(joints[j].moment - expected[j].moment), 1e-8) << j;
        EXPECT_NEAR(joints[j].position, expected[j].position, 1e-12) << j;
      }
    });
  }
}

// A beam of boxes on weak joints between two walls: those that break do so on all ranks in the same step.
TEST_P(JointsOnRanks, WhatBreaksBreaksForAll) {
  Scene scene = empty_scene(1e-3, 0);
  scene.solver.max_iterations = 20000;
  constexpr int kBoxes = 12;
  for (int k = 0; k < kBoxes; ++k) add_box(scene, {0.1 * k, 0, 0}, {0.04, 0.02, 0.02}, 0.2);
  for (int k = 0; k <= kBoxes; ++k) {
    Joint joint = joint_of(JointKind::fixed, k == 0 ? kWorldBody : k - 1,
                           k == kBoxes ? kWorldBody : k, {0.1 * k - 0.05, 0, 0});
    joint.break_moment = k == 5 ? 0.01 : 5;
    scene.joints.push_back(joint);
  }
  solve_to(scene, 1e-10);
  World alone = reference_world(scene);
  for (int k = 0; k < 60; ++k) alone.step();
  const std::vector<JointRecord> expected = alone.joints();
  EXPECT_TRUE(expected[5].is_broken);
  on_ranks(GetParam(), scene, [&](World& world, Ranks& ranks) {
    for (int k = 0; k < 60; ++k) world.step();
    const std::vector<JointRecord> joints = world.joints();
    for (std::size_t j = 0; j < joints.size(); ++j)
      EXPECT_EQ(joints[j].is_broken, expected[j].is_broken) << j;
    const BodyStates states = world.states();
    if (ranks.rank() == 0) {
      EXPECT_LT(largest_difference(states.position, alone.states().position), 1e-6);
    }
  });
}

TEST_P(JointsOnRanks, ForcesOfJointsAreThoseOfAllRanks) {
  Scene scene = row_of_joints();
  solve_to(scene, 1e-9);
  const auto forces = [&](World& world) {
    world.track_forces();
    for (int k = 0; k < 60; ++k) world.step();
    return world.take_forces();
  };
  World alone = reference_world(scene);
  const MeanForces expected = forces(alone);
  on_ranks(GetParam(), scene, [&](World& world, Ranks&) {
    const MeanForces means = forces(world);
    ASSERT_EQ(means.on_joints.size(), expected.on_joints.size());
    for (std::size_t j = 0; j < means.on_joints.size(); ++j) {
      EXPECT_LT(norm(means.on_joints[j].force - expected.on_joints[j].force), 1e-3) << j;
      if (scene.joints[j].kind != JointKind::cable) {
        EXPECT_GT(norm(expected.on_joints[j].force), 1e-6) << j;
      }
    }
  });
}

}  // namespace
}  // namespace scree::physics
