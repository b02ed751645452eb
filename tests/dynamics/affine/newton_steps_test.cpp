// Newton steps that go on as a turn does (kernels/affine/bent_way.h), those that barriers block (dynamics/affine/step_damping.h),
// those out of small gaps (kernels/affine/expected_forces.h), what turns about a contact (kernels/affine/contact_modes.h), and what
// friction stops (dynamics/affine/slip_damping.h).

#include <gtest/gtest.h>

#include "host/meshes.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/physics/joint_scenes.h"
#include "tests/turned_solid.h"

namespace scree::affine {
namespace {

using namespace test;
using physics::add_box;

/// Newton iterations of a step on average, all of which are to converge.
double iterations_a_step(const Scene& scene, int steps) {
  World world(scene, cpu_options());
  double iterations = 0;
  for (int k = 0; k < steps; ++k) {
    const StepReport report = world.step();
    EXPECT_TRUE(report.converged) << "step " << k;
    iterations += report.iterations;
  }
  return iterations / steps;
}

/// A rod on a hinge at its end that turns by 0.6 rad a step.
Scene spinning_rod() {
  constexpr double kSpin = 60;
  Scene scene = affine_scene(0.01, 0, 1);
  scene.gravity = {};
  scene.dynamics.parameters["tolerance"] = 1e-6;
  BodyDescription& rod = add_box(scene, {0, 0, -0.5}, {0.01, 0.01, 0.5}, 1);
  rod.angular_velocity = {0, kSpin, 0};
  rod.velocity = {-0.5 * kSpin, 0, 0};
  scene.joints = {physics::joint_of(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0})};
  return scene;
}

// Along straight ways alone it takes 8 iterations a step.
TEST(AffineBentWays, ARodThatTurnsFarInAStepTakesFewIterationsAndStaysOnItsHinge) {
  World world(spinning_rod(), cpu_options());
  double iterations = 0, apart = 0;
  constexpr int kSteps = 50;
  for (int k = 0; k < kSteps; ++k) {
    const StepReport report = world.step();
    iterations += report.iterations;
    EXPECT_TRUE(report.converged);
    const std::vector<Vec3d> node = world.save().at<Vec3d>("affine/position");
    apart = std::max(apart, norm(node[0] + 0.5 * node[3]));
  }
  EXPECT_LT(iterations / kSteps, 6.5);
  EXPECT_LT(apart, 1e-12);
}

// A block of 2 m slides down a slope, over its side by 5 cm, and tips off its end. In one step it comes within 1e-7 m of an edge
// along which it turns: all 200 iterations went along that gap.
TEST(AffineStepDamping, ABlockThatTurnsAlongATinyGapGetsAway) {
  for (const double along : {0.6356, 0.3356}) {
    Scene scene = affine_scene(0.025, 0.15, 1);
    scene.dynamics.parameters["reach"] = 1e-3;
    scene.dynamics.parameters["tolerance"] = 1e-6;
    scene.dynamics.parameters["stiffness"] = 1e9;
    scene.gravity = {0, -physics::kGravity, 0};
    const Quat<double> turn = exp_map(Vec3d{0, 0, physics::radians(30)});
    physics::add_wall_box(scene, {}, {4, 0.1, 2}).orientation = turn;
    BodyDescription& block =
        add_box(scene, rotate(turn, Vec3d{along, 1.1009, -1.05}), {1, 1, 1}, 4000);
    block.orientation = turn;
    World world(scene, cpu_options());
    for (int k = 0; k < 100; ++k) EXPECT_TRUE(world.step().converged) << "step " << k;
  }
}

/// A cube that slides on a floor at 10 m/s, and over its end.
Scene sliding_cube() {
  Scene scene = affine_scene(0.01, 0.05, 1);
  scene.dynamics.parameters["reach"] = 1e-3;
  scene.dynamics.parameters["tolerance"] = 1e-2;
  physics::add_wall_box(scene, {4, 0, -0.5}, {5, 5, 0.5});
  add_box(scene, {0, 0, 0.5005}, {0.5, 0.5, 0.5}, 1000).velocity = {10, 0, 0};
  return scene;
}

// With contacts as stiff as the barrier from the first step on it takes 6.4.
TEST(AffineExpectedForces, ACubeThatSlidesTakesFewIterations) {
  EXPECT_LT(iterations_a_step(sliding_cube(), 120), 6);
}

/// Between two radii, of so many sides.
TriangleMesh ring(int sides, double inner, double outer, double half) {
  return turned_solid({{outer, -half}, {outer, half}, {inner, half}, {inner, -half}}, sides);
}

// What turns about a contact is as stiff as the bodies are heavy, not as triangles there are small: with the latter it takes 15.8.
TEST(AffineTurningTerms, AShaftOfFineTrianglesTakesFewIterations) {
  constexpr int kSides = 200;
  Scene scene = affine_scene(0.01, 0, 1);
  scene.dynamics.parameters["reach"] = 1e-3;
  scene.dynamics.parameters["tolerance"] = 1e-6;
  scene.gravity = {-physics::kGravity, 0, -1};
  physics::add_mesh(scene, ring(kSides, 0.105, 0.15, 0.1));
  BodyDescription shaft;
  shaft.angular_velocity = {0, 0, 10};
  set_free_mesh(scene, shaft, ring(kSides, 0.05, 0.1, 0.3));
  set_mass_from_density(shaft, 1000);
  scene.bodies.push_back(shaft);
  EXPECT_LT(iterations_a_step(scene, 60), 13.5);
}

// Planks that fall on each other after one is hit. Without damping, and with steps that may lower the energy by as little as they like,
// it takes 15.9.
TEST(AffineSlipDamping, ContactsThatStopTakeFewIterations) {
  Scene scene = affine_scene(0.01, 0.3, 1);
  scene.dynamics.parameters["reach"] = 1e-3;
  scene.dynamics.parameters["tolerance"] = 1e-3;
  physics::add_wall_box(scene, {0, 0, -0.1}, {5, 5, 0.1});
  for (int k = 0; k < 10; ++k) add_box(scene, {0.2 * k, 0, 0.3005}, {0.02, 0.15, 0.3}, 4);
  add_box(scene, {-0.5, 0.05, 0.5}, {0.1, 0.1, 0.1}, 8).velocity = {4, 0, 0};
  EXPECT_LT(iterations_a_step(scene, 150), 14.5);
}

}  // namespace
}  // namespace scree::affine
