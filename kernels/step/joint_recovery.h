#pragma once
// How fast joints come back to where they belong. docs/theory.md, section "Joints".

#include "kernels/contact/joint_row.h"
#include "kernels/step/joint_measure.h"

namespace scree {

/// Scale of the moment rows: the radius of the smaller free body [m].
SCREE_HD inline double length_of_joint(const JointSide& a, const JointSide& b) {
  return b.is_free && b.radius < a.radius ? b.radius : a.radius;
}

/// Speed that takes an error away in the step, or the largest that is allowed [m/s].
/// @param length  of the error's unit [m]
/// @param most    [m/s]
SCREE_HD inline Vec3<double> joint_recovery(const Vec3<double>& error, double length,
                                            double time_step, double most) {
  const Vec3<double> speed = (length / time_step) * error;
  const double size = norm(speed);
  return size > most ? (most / size) * speed : speed;
}

/// How far the points of the body that reaches less far are from an axis through the anchor [m].
SCREE_HD inline double reach_of_joint(const JointSide& a, const JointSide& b,
                                      const Vec3<double>& axis) {
  const auto reach = [&](const JointSide& s) {
    return norm(s.arm - dot(s.arm, axis) * axis) + s.radius;
  };
  const double of_a = reach(a), of_b = reach(b);
  return of_b < of_a ? of_b : of_a;
}

/// Velocity of the last row over the speed of the points that it moves farthest: rows that turn bodies are measured at their length, from
/// which the points of a body are far where the anchor is not in its middle.
template <class Real>
SCREE_HD double share_of_points(const JointRow<Real>& row, const JointSide& a, const JointSide& b) {
  if (row.force_is_last) return 1;
  return length_of_joint(a, b) / reach_of_joint(a, b, Vec3<double>(row.axes[2]));
}

}  // namespace scree
