// Joints that begin beyond their limits come back at the recovery speed: so fast goes the point of the body that is farthest
// from what it turns about, wherever the anchor is.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/physics/joint_scenes.h"

namespace scree::physics {
namespace {

constexpr double kHalf = 0.5;         // of a rod along x [m]
constexpr double kHalfWidth = 0.025;  // [m]
constexpr double kRecovery = 0.5;     // the default of scenes [m/s]
constexpr double kAngle = 0.2;        // beyond the limits at first [rad]
constexpr double kRounding = 0.01;    // a ball about the rod reaches farther than its ends by less

/// A joint of the world and a rod, with its anchor at the origin.
struct OffJoint {
  std::string name;
  Joint joint;
  double center = kHalf;  ///< of the rod [m]
  double off = kAngle;    ///< at first [rad or m]
  double along = 0;  ///< from the anchor to the farthest point [m]; 0: it is a way that comes back
};

Joint off_joint(JointKind kind, const Vec3d& axis) {
  return joint_of(kind, kWorldBody, 0, {}, axis);
}

std::vector<OffJoint> off_joints() {
  const std::array<double, 2> beyond{-1, -kAngle};
  std::vector<OffJoint> out;
  Joint hinge = off_joint(JointKind::hinge, {0, 1, 0});
  hinge.limits = beyond;
  out.push_back({"hinge in the middle", hinge, 0, kAngle, kHalf});
  out.push_back({"hinge at an end", hinge, kHalf, kAngle, 2 * kHalf});
  out.push_back({"hinge off the rod", hinge, 2, kAngle, 2 + kHalf});
  Joint turned = hinge;
  std::swap(turned.bodies[0], turned.bodies[1]);
  out.push_back({"hinge of rod and world", turned, kHalf, kAngle, 2 * kHalf});
  Joint across = hinge;
  across.anchor = {0, 5, 0};
  out.push_back({"hinge far along its axis", across, kHalf, kAngle, 2 * kHalf});

  Joint cylindrical = off_joint(JointKind::cylindrical, {0, 1, 0});
  cylindrical.turn.limits = beyond;
  out.push_back({"cylindrical, turn", cylindrical, kHalf, kAngle, 2 * kHalf});
  Joint sliding = off_joint(JointKind::cylindrical, {0, 1, 0});
  sliding.limits = {kAngle, 1};
  out.push_back({"cylindrical, way", sliding});
  Joint slider = off_joint(JointKind::slider, {0, 1, 0});
  slider.limits = {kAngle, 1};
  out.push_back({"slider", slider});

  Joint universal = off_joint(JointKind::universal, {0, 1, 0});
  universal.second_axis = {0, 0, 1};
  universal.limits = beyond;
  out.push_back({"universal", universal, kHalf, kAngle, 2 * kHalf});
  universal.limits = off_joint(JointKind::ball, {}).limits;
  universal.second_turn.limits = beyond;
  out.push_back({"universal, second turn", universal, kHalf, kAngle, 2 * kHalf});

  Joint cone = off_joint(JointKind::ball, {1, 0, 0});
  cone.swing = 0.2;
  cone.swing_axis = Vec3d{std::cos(0.2 + kAngle), std::sin(0.2 + kAngle), 0};
  out.push_back({"ball, cone", cone, kHalf, kAngle, 2 * kHalf});
  Joint twist = off_joint(JointKind::ball, {0, 1, 0});
  twist.limits = beyond, twist.swing = 1;
  out.push_back({"ball, twist", twist, kHalf, kAngle, 2 * kHalf});

  Joint cable = line_of(JointKind::cable, kWorldBody, 0, {0, 0, 1}, {});
  cable.length = 0.98;  // the rod has hardly begun to turn by then
  out.push_back({"cable", cable, kHalf, 0.02});
  return out;
}

class JointRecovery : public JointTest {};
INSTANTIATE_TEST_SUITE_P(Precisions, JointRecovery,
                         testing::Values(Precision::single_precision, Precision::double_precision),
                         name_of_precision);

/// Of the two ends of a rod [m/s].
double fastest_end(const BodyStates& s, std::size_t i) {
  double most = 0;
  for (const double side : {-kHalf, kHalf}) {
    const Vec3d arm = rotate(s.orientation[i], {side, 0, 0});
    most = std::max(most, norm(s.velocity[i] + cross(s.angular_velocity[i], arm)));
  }
  return most;
}

TEST_P(JointRecovery, OfAnyKindWithItsAnchorAnywhere) {
  constexpr double kStep = 1e-3;
  for (const OffJoint& wanted : off_joints()) {
    SCOPED_TRACE(wanted.name);
    Scene scene = empty_scene(kStep, 0);
    scene.gravity = {};
    add_box(scene, {wanted.center, 0, 0}, {kHalf, kHalfWidth, kHalfWidth}, 2);
    scene.joints.push_back(wanted.joint);
    World world = world_of(scene);
    const double way = wanted.along > 0 ? wanted.off * wanted.along : wanted.off;
    const int steps = static_cast<int>(std::floor(way / (kRecovery * kStep)));
    double least = 1e300, most = 0;
    for (int k = 0; k < steps; ++k) {
      world.step();
      const double speed = fastest_end(world.states(), 0);
      least = std::min(least, speed);
      most = std::max(most, speed);
    }
    EXPECT_NEAR(least, kRecovery, kRounding * kRecovery);
    EXPECT_NEAR(most, kRecovery, kRounding * kRecovery);
    run_converged(world, steps / 50 + 3);
    EXPECT_LT(world.step().max_joint_error, is_double() ? 1e-7 : 1e-5);
  }
}

// Of two free rods each reaches as far as the other: the one goes at that speed as seen from the other one.
TEST_P(JointRecovery, OfTwoFreeRodsByTheirEnds) {
  Scene scene = empty_scene(1e-3, 0);
  scene.gravity = {};
  for (const double side : {-1.0, 1.0})
    add_box(scene, {side * kHalf, 0, 0}, {kHalf, kHalfWidth, kHalfWidth}, 2);
  scene.joints.push_back(joint_of(JointKind::hinge, 0, 1, {}, {0, 1, 0}));
  scene.joints[0].limits = {-1, -kAngle};
  World world = world_of(scene);
  for (int k = 0; k < 350; ++k) {
    world.step();
    const BodyStates s = world.states();
    const double rate = norm(s.angular_velocity[1] - s.angular_velocity[0]);
    ASSERT_NEAR(2 * kHalf * rate, kRecovery, kRounding * kRecovery) << k;
  }
  run_converged(world, 100);
  EXPECT_LT(world.step().max_joint_error, is_double() ? 1e-7 : 1e-5);
}

}  // namespace
}  // namespace scree::physics
