#pragma once
// Where joints come to lie at the end of a step, and the bias that takes what is off away.

#include "kernels/step/integrate.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// Moves the two bodies of joint k as the step will, and adds what the joint is off then, over the
/// step, to the bias of its rows. Solved again, the rows hold at the end of the step: the constraints
/// of SHAKE, by steps of Newton's method with the Jacobian of the start.
/// Source: Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23, 1977; docs/theory.md, "Joints".
template <class Real>
struct CorrectJoint {
  static constexpr const char* name = "correct_joint";
  BodyView<Real> bodies;           ///< at the start of the step
  Span<const Twist<Real>> solved;  ///< of the owned bodies
  JointPlaces places;
  Span<const Index> order;       ///< joint of each row
  Span<const JointState> state;  ///< of each joint
  Vec3<double> period;           ///< zero: axis not periodic [m]
  double time_step = 0;          ///< h [s]
  double recovery_speed = 0;     ///< [m/s]
  Span<JointRow<Real>> row;      ///< in and out

  /// @return  how far the joint is from where it was to be
  SCREE_HD JointSums operator()(Index k) const {
    const Index j = order[k];
    const JointFrames& joint = places.joints[j];
    if (state[j].is_broken != 0 || joint.held == 0) return {};
    const int first = places.is_turned(j) ? 1 : 0, second = 1 - first;
    JointSide a = side_of_joint(bodies, places, joint, first);
    const JointSide b = side_of_joint(bodies, places, joint, second);
    const JointMeasure now = measure_joint(joint.form, joint.held, joint.zero, a, b, period);
    JointSide a_end = moved(joint, first);
    const JointSide b_end = moved(joint, second);
    const JointMeasure end =
        measure_joint(joint.form, joint.held, joint.zero, a_end, b_end, period);

    const double h = time_step, length = length_of_joint(a, b);
    // Large errors stay in part, see joint_recovery().
    const Vec3<double> gap =
        end.gap - (now.gap - h * joint_recovery(now.gap, 1, h, recovery_speed));
    const Vec3<double> turn =
        length * end.turn -
        (length * now.turn - h * joint_recovery(now.turn, length, h, recovery_speed));
    JointRow<Real>& r = row[k];
    const JointValues<Real> off = r.rows(Vec3<Real>((1 / h) * gap), Vec3<Real>((1 / h) * turn));
    for (int i = 0; i < kJointRows; ++i)
      if ((joint.held >> i & 1u) != 0) r.bias[i] += off[i];
    JointSums sums;
    sums.max_error = norm(gap);
    const double tilt = (joint.held >> 3) != 0 ? norm(turn) : 0;
    if (tilt > sums.max_error) sums.max_error = tilt;
    return sums;
  }

 private:
  SCREE_HD JointSide moved(const JointFrames& joint, int which) const {
    const Index i = places.of(joint.body[which]);
    if (i == places.world) return side_of_joint(bodies, places, joint, which);
    const bool is_free = bodies.moves(i);
    const Vec3<Real> v = is_free ? solved[i].linear : bodies.velocity[i];
    Vec3<Real> w = is_free ? solved[i].angular : bodies.angular_velocity[i];
    Quat<Real> q = bodies.orientation[i];
    const Real h = static_cast<Real>(time_step);
    if (is_free) {
      turn_body(bodies, i, h, q, w);
    } else {
      q = normalized(exp_map(h * w) * q);
    }
    return side_at(bodies, places, joint, which, bodies.position[i] + time_step * Vec3<double>(v),
                   q);
  }
};

}  // namespace scree
