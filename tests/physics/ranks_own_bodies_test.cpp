// What each rank has of the bodies of a run, without bringing them together: World::give_own_bodies().

#include <gtest/gtest.h>

#include <set>

#include "host/error.h"
#include "host/own_bodies.h"
#include "tests/physics/rank_runs.h"

namespace scree::physics {
namespace {

/// Keeps what it is given, or refuses it.
class Kept final : public OwnBodiesSink {
 public:
  void begin(const BodyConstants&, std::optional<double> resumed_time) override {
    began = true;
    resumed = resumed_time;
  }
  void take(double at, const OwnBodies& given, const BodyConstants& all) override {
    if (refuses) throw RunError("the disk of this rank is full");
    time = at;
    bodies = given;
    constants = all.size();
  }
  bool refuses = false, began = false;
  std::optional<double> resumed;
  double time = -1;
  OwnBodies bodies;
  std::size_t constants = 0;
};

Scene thrown_block() {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_lattice(scene, 300, 8, 6, {0.02, 0.02, 0.011}, 0.022, 0.01, 2500, 5);
  for (BodyDescription& body : scene.bodies)
    if (body.kind == BodyKind::free) body.velocity = {2, 1, 0};
  return scene;
}

TEST(OwnBodies, OnesThatAreNoMoreAreNotAmongThem) {
  const Scene scene = thrown_block();
  World world = reference_world(scene);
  world.remove(7);
  Kept kept;
  world.begin_own_bodies(kept, {});
  const std::vector<std::int64_t> given = world.give_own_bodies(kept);
  ASSERT_EQ(kept.bodies.id.size(), scene.bodies.size() - 1);
  EXPECT_EQ(given[0], std::ssize(kept.bodies.id));
  EXPECT_EQ(kept.bodies.id[6], 6);
  EXPECT_EQ(kept.bodies.id[7], 8);
  EXPECT_EQ(kept.bodies.states.position.size(), kept.bodies.id.size());
  EXPECT_EQ(kept.bodies.states.position[7].x, world.states().position[8].x);
}

/// Rows of a rank are those of states(), which rank 0 has of all.
void expect_rows(const OwnBodies& own, const BodyStates& all, std::set<int>& seen) {
  for (std::size_t k = 0; k < own.id.size(); ++k) {
    if (k > 0) {
      EXPECT_LT(own.id[k - 1], own.id[k]);
    }
    EXPECT_TRUE(seen.insert(own.id[k]).second) << own.id[k];
    const auto id = static_cast<std::size_t>(own.id[k]);
    EXPECT_EQ(own.states.position[k], all.position[id]);
    EXPECT_EQ(own.states.velocity[k], all.velocity[id]);
    EXPECT_EQ(own.states.angular_velocity[k], all.angular_velocity[id]);
  }
}

class OwnBodiesOnRanks : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Ranks, OwnBodiesOnRanks, testing::Values(1, 2, 3),
                         testing::PrintToStringParamName());

TEST_P(OwnBodiesOnRanks, AreAllBodiesOnce) {
  const Scene scene = thrown_block();
  std::vector<Kept> kept(static_cast<std::size_t>(GetParam()));
  BodyStates all;
  std::vector<std::int64_t> given;
  on_ranks(GetParam(), scene, [&](World& world, Ranks& ranks) {
    for (int k = 0; k < 40; ++k) world.step();  // some have changed their rank
    Kept& own = kept[static_cast<std::size_t>(ranks.rank())];
    world.begin_own_bodies(own, 0.5);
    const std::vector<std::int64_t> counts = world.give_own_bodies(own);
    const BodyStates states = world.states();
    if (ranks.rank() == 0) all = states, given = counts;
  });
  std::set<int> seen;
  ASSERT_EQ(given.size(), kept.size());
  for (std::size_t rank = 0; rank < kept.size(); ++rank) {
    EXPECT_TRUE(kept[rank].began);
    EXPECT_EQ(kept[rank].resumed, 0.5);
    EXPECT_DOUBLE_EQ(kept[rank].time, 0.04);
    EXPECT_EQ(kept[rank].constants, scene.bodies.size());
    EXPECT_EQ(std::ssize(kept[rank].bodies.id), given[rank]);
    expect_rows(kept[rank].bodies, all, seen);
  }
  EXPECT_EQ(seen.size(), scene.bodies.size());
}

TEST(OwnBodiesOfRanks, WhatFailsOnOneIsThrownOnAll) {
  const Scene scene = thrown_block();
  on_ranks(3, scene, [&](World& world, Ranks& ranks) {
    Kept own;
    own.refuses = ranks.rank() == 1;
    try {
      world.give_own_bodies(own);
      ADD_FAILURE() << "rank " << ranks.rank();
    } catch (const RunError& error) {
      EXPECT_STREQ(error.what(), "the disk of this rank is full");
    }
    EXPECT_EQ(world.step().step, 1);  // and all can go on
  });
}

TEST(OwnBodiesOfRanks, AreGivenWhenRankZeroLeads) {
  const Scene scene = thrown_block();
  run_thread_ranks(3, [&](const std::shared_ptr<Ranks>& ranks) {
    WorldOptions options = cpu_options(1, Precision::double_precision);
    options.ranks = ranks;
    options.rank_calls = RankCalls::led;
    Kept own;
    if (ranks->rank() > 0) {
      follow_worlds(scene, options, &own);
      EXPECT_TRUE(own.began);
      EXPECT_EQ(own.resumed, std::nullopt);
      EXPECT_DOUBLE_EQ(own.time, 1e-3);
      EXPECT_FALSE(own.bodies.id.empty());
      return;
    }
    {
      World world(scene, options);
      world.begin_own_bodies(own, std::nullopt);
      world.step();
      EXPECT_EQ(world.give_own_bodies(own).size(), 3u);
    }
    release_followers(*ranks);
  });
}

}  // namespace
}  // namespace scree::physics
