// Motors that nothing bounds, and prescribed bodies, against joints and contacts that do not let them: bodies go where the least
// squares of what is left take them, and no faster than what drives them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

/// Kinetic energy of two bodies of 1 kg without that of their common motion, after a step [J].
double inner_energy(const StepReport& report, const World& world) {
  const std::vector<Vec3d> v = world.states().velocity;
  return report.kinetic_energy - norm2(v[0] + v[1]) / 4;
}

Joint driven(JointKind kind, int a, int b, const Vec3d& anchor, const Vec3d& axis, double speed) {
  Joint joint = joint_of(kind, a, b, anchor, axis);
  joint.motor = JointMotor{.speed = speed};
  return joint;
}

class ContradictedJoints : public testing::TestWithParam<Precision> {
 protected:
  /// With the tolerances and limits that scenes have where they say nothing.
  static Scene scene(double gravity) {
    Scene s = empty_scene(1e-3, 0);
    s.solver = SolverSettings{};
    s.gravity = {0, 0, -gravity};
    return s;
  }
  /// Two boxes of 10 cm and 1 kg, 30 cm apart, that a joint with a motor and one of another kind hold to each other.
  static Scene two_boxes(double gravity, JointKind kind, double speed, JointKind against) {
    Scene s = scene(gravity);
    for (const double x : {0.0, 0.3}) add_box(s, {x, 0, 1}, {0.05, 0.05, 0.05}, 1);
    s.joints.push_back(driven(kind, 0, 1, {0.15, 0, 1}, {1, 0, 0}, speed));
    s.joints.push_back(joint_of(against, 0, 1, {0.15, 0, 1}));
    return s;
  }
  /// Four bars of 50 cm in a plane, one of them driven from upright with 3 rad/s. They are 5 cm thick: one after the other they
  /// press on each other before they are in a line.
  static Scene rhombus() {
    Scene s = scene(kGravity);
    constexpr double kSize = 0.5, kHalf = 0.025;
    for (const double x : {0.0, kSize}) add_box(s, {x, 0, kSize / 2}, {kHalf, kHalf, kSize / 2}, 1);
    add_box(s, {kSize / 2, 0, kSize}, {kSize / 2, kHalf, kHalf}, 2);
    s.joints.push_back(driven(JointKind::hinge, kWorldBody, 0, {}, {0, 1, 0}, 3));
    s.joints.push_back(joint_of(JointKind::hinge, kWorldBody, 1, {kSize, 0, 0}, {0, 1, 0}));
    s.joints.push_back(joint_of(JointKind::hinge, 0, 2, {0, 0, kSize}, {0, 1, 0}));
    s.joints.push_back(joint_of(JointKind::hinge, 1, 2, {kSize, 0, kSize}, {0, 1, 0}));
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(Joints, ContradictedJoints,
                         testing::Values(Precision::double_precision, Precision::single_precision),
                         name_of_precision);

/// It came to 1e20 J in 15 steps. The fixed joint comes back with 0.5 m/s, the fastest recovery: of that and the 1 m/s that the
/// motor asks for the mean is left, and none of it has momentum.
TEST_P(ContradictedJoints, ASliderWithAMotorAndAFixedJointPartSlowly) {
  for (const double gravity : {0.0, kGravity})
    for (const std::string& solver : kJointSolvers) {
      Scene s = two_boxes(gravity, JointKind::slider, 1, JointKind::fixed);
      s.solver.name = solver;
      World world(s, cpu_options(1, GetParam()));
      double most = 0, last = 0;
      for (int k = 0; k < 1000; ++k) {
        const StepReport report = world.step();
        ASSERT_FALSE(report.converged);
        ASSERT_GE(report.residual_max_joint, 0);
        last = inner_energy(report, world);
        most = std::max(most, last);
      }
      // Half of a kilogram at 0.25 m/s; in the first step at 0.5 m/s, when nothing was off.
      EXPECT_LT(most, 0.064) << solver << gravity;
      EXPECT_NEAR(last, 0.25 * 0.0625, 2e-4) << solver << gravity;
      const BodyStates end = world.states();
      EXPECT_NEAR(end.position[1].x - end.position[0].x, 0.3 + 0.25, 0.01) << solver << gravity;
      EXPECT_LT(norm(end.velocity[0] + end.velocity[1] - Vec3d{0, 0, -2 * gravity}), 1e-2);
    }
}

/// The same with other joints: none goes beyond a few times what the motor asks for.
TEST_P(ContradictedJoints, NoMotorThrowsWhatAnotherJointHolds) {
  struct Case {
    JointKind kind, against;
    double speed, most;
  };
  // A box that turns by 50 rad/s against the other has 0.5 * 1/1200 * 50^2 J.
  const std::vector<Case> cases{{JointKind::cylindrical, JointKind::fixed, 3, 1.2},
                                {JointKind::slider, JointKind::ball, 1, 0.13},
                                {JointKind::slider, JointKind::fixed, 0.2, 0.011},
                                {JointKind::hinge, JointKind::fixed, 50, 6}};
  for (const Case& c : cases) {
    const Scene s = two_boxes(0, c.kind, c.speed, c.against);
    World world(s, cpu_options(1, GetParam()));
    double most = 0;
    for (int k = 0; k < 1000; ++k) {
      const StepReport report = world.step();
      most = std::max(most, inner_energy(report, world));
    }
    EXPECT_LT(most, c.most) << static_cast<int>(c.kind);
    // What the recovery speed can hold against the motor stays.
    if (c.speed < 0.5) {
      EXPECT_NEAR(world.states().position[1].x - world.states().position[0].x, 0.3,
                  2 * c.speed * s.stepping.time_step);
    }
  }
}

/// The cause: anchors that are apart give a pair of forces a lever, so that there is a velocity that both joints have, of bodies
/// that spin by thousands of radians a second. The very first step found it where they begin so.
TEST_P(ContradictedJoints, AnchorsThatAreApartDoNotMakeBodiesSpin) {
  for (const std::string& solver : kJointSolvers) {
    Scene s = two_boxes(0, JointKind::slider, 1, JointKind::fixed);
    s.solver.name = solver;
    World world(s, cpu_options(1, GetParam()));
    // As after the motor has gone 3 mm, and a little across.
    WorldState state = world.save();
    const auto& id = std::as_const(state).at<std::int32_t>("body/id");
    const auto place = std::find(id.begin(), id.end(), 1) - id.begin();
    state.at<Vec3d>("body/position")[static_cast<std::size_t>(place)] += {0.003, 2e-5, -1e-5};
    world.restore(state);
    const StepReport report = world.step();
    EXPECT_LT(inner_energy(report, world), 1) << solver;
  }
}

/// Nothing is kept about it from step to step.
TEST_P(ContradictedJoints, GoOnFromASavedStateWithTheSameBits) {
  const Scene s = two_boxes(kGravity, JointKind::slider, 1, JointKind::fixed);
  World whole(s, cpu_options(1, GetParam())), resumed(s, cpu_options(2, GetParam()));
  for (int k = 0; k < 20; ++k) whole.step();
  resumed.restore(whole.save());
  for (int k = 0; k < 20; ++k) {
    whole.step();
    resumed.step();
    ASSERT_EQ(state_hash(whole.states()), state_hash(resumed.states())) << k;
  }
}

/// A cable to a body that goes away by 1 m/s, against a rod: it came to 4e5 J.
TEST_P(ContradictedJoints, ACableAndARodShareWhatAPrescribedBodyAsksFor) {
  Scene s = scene(kGravity);
  Motion motion;
  motion.kind = Motion::Kind::linear;
  motion.velocity = {1, 0, 0};
  add_wall_box(s, {0.5, 0, 1}, {0.05, 0.05, 0.05}, BodyKind::kinematic).motion = motion;
  add_sphere(s, {0, 0, 1}, 0.05, 1);
  s.joints.push_back(line_of(JointKind::cable, 0, 1, {0.5, 0, 1}, {0, 0, 1}));
  s.joints.push_back(line_of(JointKind::distance, kWorldBody, 1, {-0.5, 0, 1}, {0, 0, 1}));
  World world(s, cpu_options(1, GetParam()));
  double most = 0;
  for (int k = 0; k < 1000; ++k) most = std::max(most, world.step().kinetic_energy);
  EXPECT_LT(most, 0.14);  // half of the way of the prescribed body
}

/// It came to 2e6 J in float, as bars that press on each other hold what nothing bounds, and where redundant joints share their loads
/// to 43 m/s and, with steps of 2.5 ms, to 30, as that energy was taken for what contacts bring.
TEST_P(ContradictedJoints, BarsThatPressOnEachOtherStayWithTheirMotor) {
  for (const double time_step : {1e-3, 2e-3, 2.5e-3, 3e-3, 4e-3}) {
    Scene s = rhombus();
    s.stepping.time_step = time_step;
    World world(s, cpu_options(1, GetParam()));
    double fastest = 0;
    for (int k = 0; k * time_step < 1.2; ++k) {
      world.step();
      for (const Vec3d& v : world.states().velocity) fastest = std::max(fastest, norm(v));
    }
    EXPECT_LT(fastest, 5 * 3 * 0.5);  // five times the end of the driven bar
  }
}

}  // namespace
}  // namespace scree::physics
