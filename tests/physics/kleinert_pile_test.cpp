// Piles of spheres settled by somebody else's engine (Kleinert 2015): friction 0.4, gravity 10,
// floor z = 0. The one of 10192 goes on standing in this one, without rotations; a step of the one
// of 2048 is a contact problem of 3970 contacts for solvers of the exact law.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/solve/solve_problem.h"
#include "tests/physics/scene_builder.h"
#include "tests/physics/shared_data.h"

namespace scree::physics {
namespace {

/// Height below which 99 % of the centers lie, which a few loose grains on top do not move,
/// and the RMS distance of the centers from the pile's axis, which grows when the foot of
/// the pile creeps outward.
struct PileSize {
  double height = 0;
  double spread = 0;
};
PileSize size_of(const std::vector<Vec3d>& centers, std::size_t count) {
  Vec3d mean;
  std::vector<double> heights;
  for (std::size_t i = 0; i < count; ++i) {
    mean += 1.0 / static_cast<double>(count) * centers[i];
    heights.push_back(centers[i].z);
  }
  PileSize size;
  for (std::size_t i = 0; i < count; ++i)
    size.spread += std::pow(centers[i].x - mean.x, 2) + std::pow(centers[i].y - mean.y, 2);
  size.spread = std::sqrt(size.spread / static_cast<double>(count));
  const auto at = heights.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(count));
  std::nth_element(heights.begin(), at, heights.end());
  size.height = *at;
  return size;
}

/// A table of spheres on a floor; no bodies where the table cannot be read.
Scene pile_scene(const std::string& name, double time_step, std::uint8_t locks) {
  Scene scene = empty_scene(time_step, 0.4);
  scene.gravity = {0, 0, -10};
  scene.solver = SolverSettings{};
  for (const auto& r : number_rows(shared_text(shared_file("kleinert/" + name)))) {
    BodyDescription& body = add_sphere(scene, {r.at(0), r.at(1), r.at(2)}, r.at(6), r.at(7));
    body.velocity = {r.at(3), r.at(4), r.at(5)};
    body.locks = locks;
  }
  if (!scene.bodies.empty()) add_plane(scene);
  return scene;
}

TEST(KleinertPile, StandsForTwoSeconds) {
  const Scene scene = pile_scene("particles10192pile.csv", 4e-3, lock_rotation);
  if (scene.bodies.empty()) GTEST_SKIP() << "no table of the pile";
  constexpr std::size_t spheres = 10192;
  ASSERT_EQ(scene.bodies.size(), spheres + 1);

  World world(scene, cpu_options(0, Precision::single_precision));
  const PileSize before = size_of(world.states().position, spheres);
  StepReport report = run_for(world, scene, 2);
  const PileSize after = size_of(world.states().position, spheres);
  RecordProperty("height_ratio", std::to_string(after.height / before.height));
  RecordProperty("spread_ratio", std::to_string(after.spread / before.spread));
  RecordProperty("kinetic_energy", std::to_string(report.kinetic_energy));
  RecordProperty("contacts", report.contact_count);
  EXPECT_NEAR(after.height / before.height, 1, 0.02);
  EXPECT_NEAR(after.spread / before.spread, 1, 0.02);
}

/// The proximal method from zero wanders at 1e-3 here, where Newton finds no way down; sweeps lead
/// to where it does.
TEST(KleinertPile, AutoSolvesAStepWithExactFriction) {
  Scene scene = pile_scene("particles2048pile.csv", 1e-3, 0);
  if (scene.bodies.empty()) GTEST_SKIP() << "no table of the pile";
  scene.stepping.envelope = 1e-4;
  scene.solver.max_iterations = 10;
  World world(scene, cpu_options(1, Precision::double_precision));
  BodyProblem step;
  world.step(step);
  std::fill(step.bias.begin(), step.bias.end(), 0);
  const ReadyProblem problem = ready("pile", {step, {}, {}, {}});
  EXPECT_GT(problem.problem.contact_count, 3900);

  AssembledOptions options;
  options.tolerance = 1e-8;
  options.max_seconds = 400;  // for slow machines: 37 on a quiet one
  const AssembledResult result = run_solvers(problem, {"auto"}, options).front().result;
  EXPECT_EQ(result.status, AssembledStatus::converged) << result.residual.relative;
  const std::vector<double> u = contact_velocity(problem.problem, result.r);
  double square = 0;
  for (const double q : problem.problem.q) square += q * q;
  const double allowed = options.tolerance * std::sqrt(square);
  for (int c = 0; c < problem.problem.contact_count; ++c) {
    const double* r = &result.r[3 * c];
    EXPECT_GE(u[3 * c], -allowed);
    EXPECT_LE(std::hypot(r[1], r[2]), problem.problem.mu[c] * r[0] + 2 * allowed);
  }
}

}  // namespace
}  // namespace scree::physics
