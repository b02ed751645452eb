// Bodies between joints in a straight line: rows are nearly dependent, and small errors ask for large velocities.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

struct LineRun {
  double error = 0, energy = 0;  ///< the largest [m], [J]
  BodyStates end;
};

LineRun run_of_line(const Scene& scene, int steps, Precision precision) {
  World world(scene, cpu_options(1, precision));
  LineRun run;
  for (int k = 0; k < steps; ++k) {
    const StepReport report = world.step();
    run.error = std::max(run.error, report.max_joint_error);
    run.energy = std::max(run.energy, report.kinetic_energy);
  }
  run.end = world.states();
  return run;
}

class JointsInLine : public testing::TestWithParam<Precision> {
 protected:
  static Scene scene() {
    Scene s = empty_scene(1e-3, 0);
    s.solver = SolverSettings{};
    return s;
  }
  /// A ball between two points that are 1 m off on either side.
  static Scene ball_between(JointKind kind, double length) {
    Scene s = scene();
    add_sphere(s, {}, 0.05, 1);
    for (const double side : {1.0, -1.0}) {
      Joint joint = line_of(kind, kWorldBody, 0, {side, 0, 0}, {});
      joint.length = length;
      s.joints.push_back(joint);
    }
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(Joints, JointsInLine,
                         testing::Values(Precision::double_precision, Precision::single_precision),
                         name_of_precision);

/// It came to 1e24 J, and the run ended.
TEST_P(JointsInLine, ATautChainOfRodsStays) {
  Scene s = scene();
  constexpr int kRods = 7;
  for (int k = 0; k < kRods; ++k) {
    add_box(s, {0.2 * k + 0.1, 0, 0}, {0.1, 0.01, 0.01}, 0.2);
    s.joints.push_back(joint_of(JointKind::ball, k - 1, k, {0.2 * k, 0, 0}));
  }
  s.joints[0].bodies[0] = kWorldBody;
  s.joints.push_back(joint_of(JointKind::ball, kRods - 1, kWorldBody, {0.2 * kRods, 0, 0}));
  const LineRun run = run_of_line(s, 500, GetParam());
  EXPECT_LT(run.error, 0.05);
  EXPECT_LT(run.energy, 1000);
  EXPECT_LT(norm(run.end.position[3] - Vec3d{0.7, 0, 0}), 0.05);
}

/// It came to 4e4 J.
TEST_P(JointsInLine, TwoRodsThatAreATouchTooLongHold) {
  const LineRun run = run_of_line(ball_between(JointKind::distance, 1.0001), 500, GetParam());
  EXPECT_LT(run.error, 2e-4);
  EXPECT_LT(run.energy, 1);
}

/// The ball was 5,000 km off.
TEST_P(JointsInLine, TwoCablesThatAreTooShortHold) {
  const LineRun run = run_of_line(ball_between(JointKind::cable, 0.999), 500, GetParam());
  EXPECT_LT(run.error, 2e-3);
  EXPECT_LT(norm(run.end.position[0]), 0.01);
}

/// A hinge beside the center of a body that may not move across it: it cannot turn.
TEST_P(JointsInLine, AHingeAndALockHold) {
  Scene s = scene();
  add_box(s, {}, {0.6, 0.05, 0.05}, 1).locks = lock_x;
  s.joints.push_back(joint_of(JointKind::hinge, 0, kWorldBody, {0.5, 0, 0}, {0, 1, 0}));
  const LineRun run = run_of_line(s, 500, GetParam());
  EXPECT_LT(run.error, 1e-6);
  EXPECT_LT(run.energy, 0.01);
}

/// Rods of 0.1 kg from one hook to the other, 0.2 m each, in a line or hanging through by the sag.
Scene chain_between_hooks(int links, JointKind kind, double time_step, double sag = 0) {
  Scene scene = empty_scene(time_step, 0);
  scene.solver = SolverSettings{};
  const auto knot = [&](int k) {
    const double x = 2.0 * k / links - 1;
    return Vec3d{0.2 * k, 0, -sag * (1 - x * x)};
  };
  for (int k = 0; k < links; ++k) {
    const Vec3d way = knot(k + 1) - knot(k);
    add_box(scene, 0.5 * (knot(k) + knot(k + 1)), {0.08, 0.02, 0.02}, 0.1).orientation =
        exp_map(Vec3d{0, -std::atan2(way.z, way.x), 0});
  }
  for (int k = 0; k <= links; ++k)
    scene.joints.push_back(joint_of(kind, k == 0 ? kWorldBody : k - 1, k == links ? kWorldBody : k,
                                    knot(k), {0, 1, 0}));
  return scene;
}

// What goes across the line is pulled back to it in each step: energy from nowhere, unless a step looks.
TEST(ChainBetweenHooks, HangsWhereItIsStraight) {
  for (const int links : {3, 4})
    for (const JointKind kind : {JointKind::ball, JointKind::hinge})
      for (const double step : {4e-3, 1e-3, 2.5e-4}) {
        const Scene scene = chain_between_hooks(links, kind, step);
        const LineRun most = run_of_line(scene, steps_for(scene, 0.6), Precision::double_precision);
        EXPECT_LT(most.energy, 0.01) << links << ", steps of " << step;
        EXPECT_LT(most.error, 1e-5) << links << ", steps of " << step;
      }
  const LineRun in_float =
      run_of_line(chain_between_hooks(3, JointKind::ball, 1e-3), 600, Precision::single_precision);
  EXPECT_LT(in_float.energy, 0.05);
}

TEST(ChainBetweenHooks, ThatIsStruckHasNoMoreEnergyThanTheBall) {
  for (const double restitution : {0.0, 0.8})
    for (const double sag : {0.0, 1e-4, 1e-3, 1.2e-2})
      for (const double step : {1e-3, 2e-4}) {
        Scene scene = chain_between_hooks(6, JointKind::ball, step, sag);
        scene.gravity = {};
        scene.materials[0].restitution = restitution;
        add_sphere(scene, {0.5, 0, 0.09}, 0.05, 1).velocity = {0, 0, -1};
        const LineRun most = run_of_line(scene, steps_for(scene, 0.2), Precision::double_precision);
        EXPECT_LT(most.energy, 0.6) << restitution << ", sag " << sag << ", steps of " << step;
      }
}

}  // namespace
}  // namespace scree::physics
