// Joints with exact Coulomb friction: closed forms, and one step by every solver.

#include <gtest/gtest.h>

#include "tests/physics/joint_scenes.h"
#include "tests/physics/rank_runs.h"

namespace scree::physics {
namespace {

/// Two balls held together, in a groove of 90 degrees along x: they slide, and cannot roll.
Scene sledge(double slope) {
  constexpr double kRadius = 0.1;
  const double s = std::sqrt(0.5);
  Scene scene = empty_scene(1e-3, 0.25, Model::exact);
  solve_to(scene, 1e-9);
  tilt(scene, slope);
  add_plane(scene, {0, s, s});
  add_plane(scene, {0, -s, s});
  for (const double x : {0.0, 0.3}) add_sphere(scene, {x, 0, kRadius / s}, kRadius, x > 0 ? 2 : 1);
  scene.joints.push_back(joint_of(JointKind::fixed, 2, 3, {0.15, 0, kRadius / s}));
  return scene;
}

/// Coulomb's law holds the wedge of both normals up to tan(slope) = mu / sin 45, 19.47 degrees; the convex law up to 20.06.
TEST(JointsWithExactFriction, ASledgeInAGrooveSlipsWhereItShould) {
  for (const double slope : {19.3, 19.6, 25.0}) {
    const Scene scene = sledge(slope);
    World world = reference_world(scene);
    for (int k = 0; k < 200; ++k) EXPECT_TRUE(world.step().converged) << slope << ' ' << k;
    const double acceleration =
        kGravity * (std::sin(radians(slope)) - 0.25 / std::sqrt(0.5) * std::cos(radians(slope)));
    const BodyStates states = world.states();
    for (const int ball : {2, 3})
      EXPECT_NEAR(states.velocity[static_cast<std::size_t>(ball)].x,
                  std::max(acceleration, 0.0) * world.time(), 1e-4)
          << slope;
  }
}

TEST(JointsWithExactFriction, AllSolversFindTheSameStep) {
  Scene scene = row_of_joints();
  scene.solver.exact_coulomb = true;
  const WorldState start = landed(scene, 0.12);
  BodyStates first;
  for (const std::string& solver : kJointSolvers) {
    SCOPED_TRACE(solver);
    scene.solver = SolverSettings{};
    scene.solver.name = solver;
    scene.solver.exact_coulomb = true;
    solve_to(scene, 1e-10);
    scene.solver.max_iterations = 200000;
    World world = reference_world(scene);
    world.restore(start);
    const StepReport report = world.step();
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.exact_residual_rms, 1e-10);
    if (first.velocity.empty()) first = world.states();
    EXPECT_LT(largest_difference(world.states().velocity, first.velocity), 1e-6);
  }
}

TEST(JointsWithExactFriction, RanksFindTheStepOfOne) {
  Scene scene = row_of_joints(20, 0.5);
  scene.solver.exact_coulomb = true;
  const WorldState start = landed(scene, 0.12);
  for (const char* solver : {"apgd", "gauss_seidel_colored"}) {
    scene.solver.name = solver;
    solve_to(scene, 1e-11);
    scene.solver.max_iterations = 200000;
    const auto [one, more] = compared_step(3, scene, start, 1e-6);
    EXPECT_TRUE(more.converged && one.converged) << solver;
  }
}

}  // namespace
}  // namespace scree::physics
