// Scenes that several ranks simulate together on GPUs: ranks are threads, which share the GPUs that there are.

#include <algorithm>

#include "host/ranks/thread_ranks.h"
#include "host/scene/bed_scene.h"
#include "host/state_hash.h"
#include "tests/parity/parity.h"
#include "tests/physics/joint_scenes.h"

namespace scree::parity {
namespace {

class ParityRanks : public Parity {};

/// States at rank 0 after so many steps from a state.
struct RankedOutcome {
  BodyStates states;
  StepReport report;
};

RankedOutcome on_gpus(int ranks, const Scene& scene, const WorldState* start, int steps,
                      Precision precision) {
  RankedOutcome outcome;
  run_thread_ranks(ranks, [&](const std::shared_ptr<Ranks>& group) {
    WorldOptions options;
    options.backend = BackendKind::cuda;
    options.precision = precision;
    options.device = group->rank() % device_count(BackendKind::cuda);
    options.ranks = group;
    World world(scene, options);
    if (start != nullptr) world.restore(*start);
    StepReport report;
    for (int k = 0; k < steps; ++k) report = world.step();
    BodyStates states = world.states();
    if (group->rank() == 0) outcome = {std::move(states), report};
  });
  return outcome;
}

TEST_F(ParityRanks, OneStepIsThatOfOneRank) {
  for (const Precision precision : {Precision::double_precision, Precision::single_precision}) {
    const bool is_double = precision == Precision::double_precision;
    SCOPED_TRACE(is_double ? "double" : "float");
    Scene scene = bed_scene({.count = 4000}, {});
    World settles = world_on(BackendKind::cuda, scene, precision);
    for (int k = 0; k < 60; ++k) settles.step();
    const WorldState start = settles.save();
    scene.solver.stop = {StopRule::Level::absolute, is_double ? 1e-10 : 2e-6};
    scene.solver.max_iterations = 20000;
    World one = world_on(BackendKind::cuda, scene, precision);
    one.restore(start);
    const StepReport expected = one.step();
    ASSERT_TRUE(expected.converged);
    for (const int ranks : {2, 3}) {
      const RankedOutcome more = on_gpus(ranks, scene, &start, 1, precision);
      EXPECT_TRUE(more.report.converged);
      EXPECT_EQ(more.report.contact_count, expected.contact_count) << ranks;
      EXPECT_LT(largest_difference(more.states.velocity, one.states().velocity),
                is_double ? 1e-7 : 2e-3)
          << ranks;
      EXPECT_NEAR(more.report.kinetic_energy, expected.kinetic_energy,
                  (is_double ? 1e-8 : 1e-3) * expected.kinetic_energy);
    }
  }
}

TEST_F(ParityRanks, ExactFrictionToo) {
  Scene bed = bed_scene({.count = 4000}, {});
  bed.solver.exact_coulomb = true;
  EXPECT_TRUE(on_gpus(2, bed, nullptr, 60, Precision::single_precision).report.converged);

  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_lattice(scene, 60, 8, 6, {0.02, 0.02, 0.011}, 0.022, 0.01, 2500, 5);
  scene.solver = SolverSettings{};
  World lands = world_on(BackendKind::cuda, scene, Precision::double_precision);
  for (int k = 0; k < 120; ++k) lands.step();
  const WorldState start = lands.save();
  scene.solver.exact_coulomb = true;
  scene.solver.stop = {StopRule::Level::absolute, 1e-10};
  scene.solver.max_iterations = 100000;
  World one = world_on(BackendKind::cuda, scene, Precision::double_precision);
  one.restore(start);
  const StepReport expected = one.step();
  ASSERT_TRUE(expected.converged);
  EXPECT_GT(expected.contact_count, 40);
  const RankedOutcome two = on_gpus(2, scene, &start, 1, Precision::double_precision);
  EXPECT_TRUE(two.report.converged);
  EXPECT_LT(largest_difference(two.states.velocity, one.states().velocity), 1e-7);
}

/// Few bodies: nearly all contacts are between ranks, and most of those that are listed carry nothing.
TEST_F(ParityRanks, FewBodiesConvergeInEveryStep) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver = SolverSettings{};
  add_plane(scene);
  add_lattice(scene, 400, 5, 5, {-0.02, -0.02, 0.012}, 0.0105, 0.005, 2500, 7);
  run_thread_ranks(2, [&](const std::shared_ptr<Ranks>& group) {
    WorldOptions options;
    options.backend = BackendKind::cuda;
    options.device = group->rank() % device_count(BackendKind::cuda);
    options.ranks = group;
    World world(scene, options);
    for (int k = 0; k < 250; ++k) {
      const StepReport report = world.step();
      ASSERT_TRUE(report.converged) << k << ": " << report.residual_relative;
      ASSERT_LT(report.max_penetration, 5e-5) << k;
    }
  });
}

/// A rank without bodies, and without contacts, takes part in all that the others do.
TEST_F(ParityRanks, OneBodyOnTwoRanks) {
  Scene scene = empty_scene(1e-3, 0.5);
  scene.solver = SolverSettings{};
  add_plane(scene);
  add_lattice(scene, 1, 1, 1, {0, 0, 0.0055}, 0.0105, 0.005, 2500, 7);
  const RankedOutcome two = on_gpus(2, scene, nullptr, 100, Precision::single_precision);
  EXPECT_TRUE(two.report.converged);
  EXPECT_EQ(two.report.contact_count, 1);
  EXPECT_NEAR(two.states.position.back().z, 0.005, 2e-5);
}

TEST_F(ParityRanks, RunsRepeatTheirBits) {
  const Scene scene = bed_scene({.count = 4000}, {});
  const RankedOutcome first = on_gpus(2, scene, nullptr, 80, Precision::single_precision);
  const RankedOutcome second = on_gpus(2, scene, nullptr, 80, Precision::single_precision);
  EXPECT_EQ(state_hash(first.states), state_hash(second.states));
  EXPECT_TRUE(first.report.converged);
}

// Joints of all kinds over borders, with contacts.
TEST_F(ParityRanks, JointsToo) {
  Scene scene = row_of_joints();
  scene.solver.stop = StopRule();
  World lands = world_on(BackendKind::cuda, scene, Precision::double_precision);
  for (int k = 0; k < 120; ++k) lands.step();
  const WorldState start = lands.save();
  for (const char* solver : {"apgd", "gauss_seidel_colored"}) {
    scene.solver.name = solver;
    scene.solver.stop = {StopRule::Level::absolute, 1e-10};
    scene.solver.max_iterations = 100000;
    World one = world_on(BackendKind::cuda, scene, Precision::double_precision);
    one.restore(start);
    ASSERT_TRUE(one.step().converged) << solver;
    for (const int ranks : {2, 3}) {
      const RankedOutcome more = on_gpus(ranks, scene, &start, 1, Precision::double_precision);
      EXPECT_TRUE(more.report.converged) << solver;
      EXPECT_LT(largest_difference(more.states.velocity, one.states().velocity), 1e-6) << solver;
    }
  }
  scene.solver = SolverSettings{};
  scene.solver.max_iterations = 20000;
  EXPECT_TRUE(on_gpus(3, scene, &start, 100, Precision::single_precision).report.converged);
}

TEST_F(ParityRanks, JacobiAndShapesToo) {
  Scene scene = empty_scene(1e-3, 0.4);
  add_plane(scene);
  add_boxes_and_spheres(scene, 200, 6, 6);
  for (const char* solver : {"apgd", "jacobi"}) {
    SCOPED_TRACE(solver);
    scene.solver = SolverSettings{};
    scene.solver.name = solver;
    const RankedOutcome more = on_gpus(2, scene, nullptr, 200, Precision::single_precision);
    for (std::size_t i = 1; i < more.states.position.size(); ++i)
      EXPECT_GT(more.states.position[i].z, 0.006) << "body " << i;
    EXPECT_GT(more.report.contact_count, 200);
    EXPECT_LT(more.report.max_penetration, 2e-4);
  }
}

}  // namespace
}  // namespace scree::parity
