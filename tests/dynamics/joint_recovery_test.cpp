// How fast the last row of a joint takes bodies back: the points that it moves farthest go at the recovery speed.

#include "kernels/step/joint_recovery.h"

#include <gtest/gtest.h>

namespace scree {
namespace {

JointSide free_side(double radius, const Vec3<double>& arm) {
  JointSide s;
  s.is_free = true;
  s.radius = radius;
  s.arm = arm;
  return s;
}

JointRow<double> row_about(const Vec3<double>& axis, bool force_is_last = false) {
  JointRow<double> row;
  row.axes[2] = axis;
  row.force_is_last = force_is_last;
  return row;
}

TEST(JointRecovery, PointsOfABodyReachAsFarAsItsArmAndItsRadius) {
  const JointSide world, rod = free_side(0.5, {-0.3, 5, 0.4});
  EXPECT_DOUBLE_EQ(reach_of_joint(world, rod, {0, 1, 0}), 1);  // the way along the axis is none
  EXPECT_DOUBLE_EQ(reach_of_joint(rod, world, {0, 1, 0}), 1);
  EXPECT_DOUBLE_EQ(share_of_points(row_about({0, 1, 0}), world, rod), 0.5);
  EXPECT_DOUBLE_EQ(share_of_points(row_about({0, 1, 0}), world, free_side(0.5, {0, 5, 0})), 1);
  EXPECT_DOUBLE_EQ(share_of_points(row_about({0, 1, 0}, true), world, rod), 1);
}

TEST(JointRecovery, TheBodyThatReachesLessFarCounts) {
  const JointSide near = free_side(0.5, {0.1, 0, 0}), far = free_side(0.2, {-3, 0, 0});
  EXPECT_DOUBLE_EQ(reach_of_joint(near, far, {0, 0, 1}), 0.6);
  EXPECT_DOUBLE_EQ(reach_of_joint(far, near, {0, 0, 1}), 0.6);
  EXPECT_DOUBLE_EQ(share_of_points(row_about({0, 0, 1}), near, far), 0.2 / 0.6);
}

}  // namespace
}  // namespace scree
