// One step from a settled state, on both backends, solved to the same residual.

#include "tests/parity/parity.h"
#include "tests/physics/column.h"
#include "tests/physics/state_hash.h"

namespace scree::parity {
namespace {

/// The column of grains, which stands on its own for the one step looked at. The velocities
/// compared are those after the step, which starts it moving.
Scene standing_column(double residual) {
  static const Column column = cut_column(800);
  Scene scene = column_scene(column, 5e-4);
  solve_to(scene, residual);
  scene.solver.max_iterations = 50000;
  scene.solver.check_every = 50;
  return scene;
}

class ParityStep : public Parity {};

TEST_F(ParityStep, DoublePrecision) {
  const Scene scene = standing_column(1e-12);
  World cpu = world_on(BackendKind::cpu, scene, Precision::double_precision);
  World cuda = world_on(BackendKind::cuda, scene, Precision::double_precision);
  const StepReport a = cpu.step(), b = cuda.step();
  EXPECT_TRUE(a.converged) << a.residual_rms;
  EXPECT_TRUE(b.converged) << b.residual_rms;
  EXPECT_EQ(a.contact_count, b.contact_count);
  EXPECT_GT(a.contact_count, 1000);
  EXPECT_NEAR(b.objective, a.objective, 1e-10 * std::abs(a.objective));
  EXPECT_LT(relative_rms(cpu.states(), cuda.states(), kGrain / 2), 1e-8);
}

TEST_F(ParityStep, SinglePrecision) {
  const Scene scene = standing_column(1e-7);
  World reference = world_on(BackendKind::cpu, scene, Precision::double_precision);
  const StepReport exact = reference.step();
  for (const BackendKind backend : kBackends) {
    World world = world_on(backend, scene);
    const StepReport report = world.step();
    EXPECT_TRUE(report.converged) << name_of(backend) << ' ' << report.residual_rms;
    EXPECT_EQ(report.contact_count, exact.contact_count) << name_of(backend);
    EXPECT_NEAR(report.objective, exact.objective, 1e-6 * std::abs(exact.objective))
        << name_of(backend);
    EXPECT_LT(relative_rms(reference.states(), world.states(), kGrain / 2), 1e-4)
        << name_of(backend);
  }
}

TEST_F(ParityStep, CudaGivesEqualBitsOnEveryRun) {
  static const Column column = cut_column(800);
  const Scene scene = column_scene(column, 5e-4);
  for (const Precision precision : kPrecisions) {
    World first = world_on(BackendKind::cuda, scene, precision);
    World second = world_on(BackendKind::cuda, scene, precision);
    for (int k = 0; k < 50; ++k) {
      const StepReport a = first.step(), b = second.step();
      ASSERT_EQ(a.iterations, b.iterations) << name_of(precision) << " step " << k;
      ASSERT_EQ(physics::hash_of(first.states()), physics::hash_of(second.states()))
          << name_of(precision) << " step " << k;
    }
  }
}

TEST_F(ParityStep, C32_RunOutAgrees) {
  const Column column = cut_column(800);
  const Scene scene = column_scene(column, 5e-4);
  double spread[2];
  for (const BackendKind backend : kBackends) {
    World world = world_on(backend, scene);
    run_for(world, scene, 0.5);
    spread[backend == BackendKind::cuda] = run_out(column, world.states().position);
  }
  RecordProperty("cpu", std::to_string(spread[0]));
  RecordProperty("cuda", std::to_string(spread[1]));
  EXPECT_NEAR(spread[1], spread[0], 0.1 * spread[0]);
  for (const double s : spread) {
    EXPECT_GT(s, 0.9);
    EXPECT_LT(s, 1.9);
  }
}

}  // namespace
}  // namespace scree::parity
