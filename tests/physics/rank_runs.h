#pragma once
// Runs of one scene by several ranks, which are threads here, and by one.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "host/ranks/thread_ranks.h"
#include "kernels/backend/ranks.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {

/// Runs `body` with the World of each rank.
inline void on_ranks(int count, const Scene& scene, const std::function<void(World&, Ranks&)>& body,
                     Precision precision = Precision::double_precision) {
  run_thread_ranks(count, [&](const std::shared_ptr<Ranks>& ranks) {
    WorldOptions options = cpu_options(1, precision);
    options.ranks = ranks;
    World world(scene, options);
    body(world, *ranks);
  });
}

/// What rank 0 knows after a number of steps.
struct RunResult {
  std::vector<StepReport> reports;
  BodyStates states;
  std::vector<ContactRecord> contacts;
};

inline RunResult run_on(int ranks, const Scene& scene, int steps,
                        Precision precision = Precision::double_precision) {
  RunResult run;
  on_ranks(
      ranks, scene,
      [&](World& world, Ranks& group) {
        std::vector<StepReport> reports;
        for (int k = 0; k < steps; ++k) reports.push_back(world.step());
        std::vector<ContactRecord> contacts = world.contacts();
        BodyStates states = world.states();
        if (group.rank() == 0) run = {reports, std::move(states), std::move(contacts)};
      },
      precision);
  return run;
}

inline bool same_bits(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3d)) == 0;
}

/// The state after a block has come down, with the solver's own tolerance.
inline WorldState landed(Scene scene, double seconds) {
  scene.solver = SolverSettings{};
  World world = reference_world(scene);
  run_for(world, scene, seconds);
  return world.save();
}

/// One step from a state, by one rank and by several: the same contacts and velocities.
/// @param most  difference of velocities [m/s]  @return  what both report
inline std::pair<StepReport, StepReport> compared_step(int count, const Scene& scene,
                                                       const WorldState& start, double most) {
  World alone = reference_world(scene);
  alone.restore(start);
  const StepReport one = alone.step();
  const BodyStates expected = alone.states();
  StepReport more;
  on_ranks(count, scene, [&](World& world, Ranks& ranks) {
    world.restore(start);
    const StepReport report = world.step();
    EXPECT_EQ(report.contact_count, one.contact_count);
    const BodyStates states = world.states();
    if (ranks.rank() > 0) return;
    EXPECT_LT(largest_difference(states.velocity, expected.velocity), most);
    EXPECT_LT(largest_difference(states.position, expected.position),
              scene.stepping.time_step * most + 1e-12);
    more = report;
  });
  return {one, more};
}

}  // namespace scree::physics
