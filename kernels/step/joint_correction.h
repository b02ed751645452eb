#pragma once
// Where joints come to lie at the end of a step, and the bias that takes what is off away.

#include "kernels/contact/contact_rows.h"
#include "kernels/step/integrate.h"
#include "kernels/step/joint_setup.h"

namespace scree {

/// Moves the two bodies of joint k as the step will, and adds what the joint is off then, over the
/// step, to the bias of its rows. Solved again, the rows hold at the end of the step: the constraints
/// of SHAKE, by steps of Newton's method with the Jacobian of the start. Limits and cables likewise:
/// the velocities that take the joint to where they end come from the end of the step.
/// Source: Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23, 1977; docs/theory.md, "Joints".
template <class Real>
struct CorrectJoint {
  static constexpr const char* name = "correct_joint";
  BodyView<Real> bodies;                     ///< at the start of the step
  FreeVelocity<Real> free;                   ///< without joints and contacts [bodies.count]
  Span<const GeneralInertia<Real>> inertia;  ///< [bodies.count]
  Span<const Twist<Real>> solved;            ///< of the owned bodies
  JointPlaces places;
  Span<const Index> order;       ///< joint of each row
  Span<const JointState> state;  ///< of each joint
  Vec3<double> period;           ///< zero: axis not periodic [m]
  double time_step = 0;          ///< h [s]
  double recovery_speed = 0;     ///< [m/s]
  Span<JointRow<Real>> row;      ///< in and out

  /// @return  how far the joint is from where it was to be, and where it belongs
  SCREE_HD JointSums operator()(Index k) const {
    const Index j = order[k];
    const JointFrames& joint = places.joints[j];
    JointRow<Real>& r = row[k];
    const bool turned = places.is_turned(j);
    const double sign = sign_of_joint(joint, turned);
    const JointBounds bounds = bounds_of_joint(joint.drive, sign);
    // A held last row has no limits; one that the bodies cannot follow has no velocity.
    const bool is_limited = bounds.are_there() && (joint.held >> kJointAxisRow & 1u) == 0 &&
                            r.inverse_pivot(kJointAxisRow) > Real(0);
    if (state[j].is_broken != 0) return {};
    const int first = turned ? 1 : 0, second = 1 - first;
    JointSums sums;
    note_drive(joint, r, places.of(joint.body[first]), places.of(joint.body[second]), sums);
    if (joint.held == 0 && !is_limited) return sums;
    JointSide a = side_of_joint(bodies, places, joint, first);
    const JointSide b = side_of_joint(bodies, places, joint, second);
    const JointForm form = form_of_sides(joint.form, turned);
    const JointMeasure now = measure_joint(form, joint.held, joint.zero, a, b, period);
    Twist<Real> a_twist, b_twist;
    JointSide a_end = moved(joint, first, a_twist);
    const JointSide b_end = moved(joint, second, b_twist);
    const JointMeasure end = measure_joint(form, joint.held, joint.zero, a_end, b_end, period);

    const double h = time_step, length = length_of_joint(a, b);
    // Large errors stay in part, see joint_recovery().
    const Vec3<double> gap =
        end.gap - (now.gap - h * joint_recovery(now.gap, 1, h, recovery_speed));
    const Vec3<double> turn =
        length * end.turn -
        (length * now.turn - h * joint_recovery(now.turn, length, h, recovery_speed));
    sums.left = left_of(joint, r, a_twist, b_twist);
    note_motion(joint, first, a, a_twist, sums);
    note_motion(joint, second, b, b_twist, sums);
    if (is_limited)
      sums.max_error =
          correct_limits(joint, end, sign, state[j].position,
                         h *
                             turning_about_axis(now.frame, Vec3<double>(a_twist.angular),
                                                Vec3<double>(b_twist.angular)) /
                             now.gear,
                         bounds, now.gear * length, recovery_speed * share_of_points(r, a, b),
                         JointRows<Real>::velocity(r, a_twist, b_twist), r, sums.end_error);
    const JointValues<Real> off = r.rows(Vec3<Real>((1 / h) * gap), Vec3<Real>((1 / h) * turn));
    for (int i = 0; i < kJointRows; ++i)
      if ((joint.held >> i & 1u) != 0) r.bias[i] += off[i];
    if (norm(gap) > sums.max_error) sums.max_error = norm(gap);
    const double tilt = (joint.held >> 3) != 0 ? norm(turn) : 0;
    if (tilt > sums.max_error) sums.max_error = tilt;
    if (norm(end.gap) > sums.end_error) sums.end_error = norm(end.gap);
    const double end_tilt = (joint.held >> 3) != 0 ? length * norm(end.turn) : 0;
    if (end_tilt > sums.end_error) sums.end_error = end_tilt;
    return sums;
  }

 private:
  /// The bounds of the velocity become those that take the joint from the end of the step to its limits.
  /// @param start  position at the start of the step [m or rad]
  /// @param turn   by which B turns against A in it [rad]
  /// @param length of the last row, where that is a moment [m]
  /// @param most   of its velocity back to the limits [m/s]
  /// @param u      velocities of the rows in the coordinates of solvers
  /// @param beyond  out: how far the joint ends beyond its limits [m]
  /// @return  how far beyond what is allowed of that
  SCREE_HD double correct_limits(const JointFrames& joint, const JointMeasure& end, double sign,
                                 double start, double turn, const JointBounds& bounds,
                                 double length, double most, const JointValues<Real>& u,
                                 JointRow<Real>& r, double& beyond) const {
    const double h = time_step, unit = r.force_is_last ? 1 : length;
    const double x = sign * start;
    double x_end = sign * joint_position(joint.form, end, sign, joint.zero, start + sign * turn);
    // Axes that went through each other: the angle counts as it did at the start.
    if (joint.form == JointForm::swing &&
        dot(rotate(end.frame, {0, 0, 1}), Vec3<double>(r.axes[2])) < 0)
      x_end = -x_end;
    // Where the joint is far beyond, a part of the way is allowed, see JointSetup.
    const double part = h * most / unit;
    JointBounds allowed = bounds;
    if (x - part > allowed.upper) allowed.upper = x - part;
    if (x + part < allowed.lower) allowed.lower = x + part;
    const double speed = u[kJointAxisRow];
    const double scale = static_cast<double>(r.inverse_pivot(kJointAxisRow)) * unit / h;
    r.fastest = limited_value<Real>(speed + scale * (allowed.upper - x_end));
    r.slowest = limited_value<Real>(speed + scale * (allowed.lower - x_end));
    beyond = unit * bounds.beyond(x_end);
    return unit * allowed.beyond(x_end);
  }

  /// The speed that the drive of a joint gives to what it moves beside that which this has without it, by all that it may give in
  /// the step; or that of a body that moves by itself.
  SCREE_HD void note_drive(const JointFrames& joint, const JointRow<Real>& r, Index a, Index b,
                           JointSums& sums) const {
    constexpr int k = kJointAxisRow;
    sums.forced = largest(prescribed_speed(a, joint.reach), prescribed_speed(b, joint.reach));
    sums.driven = sums.forced;
    const bool is_driven = (joint.held >> k & 1u) == 0 && joint.drive.is_used() && !r.rubs;
    if (!is_driven || !(r.inverse_pivot(k) > Real(0))) return;
    const double least = static_cast<double>(r.least), most = static_cast<double>(r.most);
    const double given = static_cast<double>(r.scale) / static_cast<double>(r.inverse_pivot(k)) *
                         largest(std::abs(least), std::abs(most));
    const JointValues<Real> u = JointRows<Real>::speeds(r, free_velocity(a), free_velocity(b));
    const double asked = std::abs(static_cast<double>(u[k] + r.bias[k]));
    const double speed = given < asked || least == most ? given : asked;
    const double unit = r.force_is_last ? 1 : joint.reach / static_cast<double>(r.length);
    sums.driven = largest(sums.driven, unit * speed);
    if (!has_bound(r)) sums.forced = largest(sums.forced, unit * speed);
  }
  static SCREE_HD bool has_bound(const JointRow<Real>& r) {
    return r.least > -largest_number<Real>() || r.compliance > Real(0);
  }
  /// The largest velocity of the rows that are held, with that of a motor without a bound.
  SCREE_HD double left_of(const JointFrames& joint, const JointRow<Real>& r,
                          const Twist<Real>& a_twist, const Twist<Real>& b_twist) const {
    const JointValues<Real> u = r.velocity(JointRows<Real>::velocity(r, a_twist, b_twist));
    double most = 0;
    for (int k = 0; k < kJointRows; ++k) {
      const bool is_held =
          (joint.held >> k & 1u) != 0 || (k == kJointAxisRow && !r.is_last_driven());
      if (is_held && r.inverse_pivot(k) > Real(0))
        most = largest(most, std::abs(static_cast<double>(u[k])));
    }
    return most;
  }
  SCREE_HD double prescribed_speed(Index i, double reach) const {
    if (i == places.world || bodies.moves(i)) return 0;
    return static_cast<double>(norm(bodies.velocity[i])) +
           reach * static_cast<double>(norm(bodies.angular_velocity[i]));
  }
  SCREE_HD Twist<Real> free_velocity(Index i) const {
    return i == places.world ? Twist<Real>{} : free[i];
  }
  static SCREE_HD double largest(double x, double y) { return x > y ? x : y; }

  SCREE_HD void note_motion(const JointFrames& joint, int which, const JointSide& side,
                            const Twist<Real>& twist, JointSums& sums) const {
    const Index i = places.of(joint.body[which]);
    if (!side.is_free || i == places.world) return;
    const double before = static_cast<double>(norm(bodies.velocity[i])) +
                          side.radius * static_cast<double>(norm(bodies.angular_velocity[i]));
    const double now = static_cast<double>(norm(twist.linear)) +
                       side.radius * static_cast<double>(norm(twist.angular));
    if (before > sums.speed_before) sums.speed_before = before;
    if (now > sums.speed) sums.speed = now;
    sums.free_energy += 0.5 * LeverArms<Real>::mass_norm2(inertia[i], free[i]);
    sums.energy += 0.5 * LeverArms<Real>::mass_norm2(inertia[i], twist);
    sums.mass += static_cast<double>(inertia[i].mass);
  }

  /// A side at the end of the step. @param twist  out: that of its body
  SCREE_HD JointSide moved(const JointFrames& joint, int which, Twist<Real>& twist) const {
    const Index i = places.of(joint.body[which]);
    twist = {};
    if (i == places.world) return side_of_joint(bodies, places, joint, which);
    const bool is_free = bodies.moves(i);
    const Vec3<Real> v = is_free ? solved[i].linear : bodies.velocity[i];
    Vec3<Real> w = is_free ? solved[i].angular : bodies.angular_velocity[i];
    twist = {v, w};
    Quat<Real> q = bodies.orientation[i];
    const Real h = static_cast<Real>(time_step);
    if (is_free) {
      turn_body(bodies, i, h, q, w);
    } else {
      q = turned_by(h * w, q);
    }
    return side_at(bodies, places, joint, which, bodies.position[i] + time_step * Vec3<double>(v),
                   q);
  }
};

/// Of what the rows of joint k were to do about errors, a share; driven rows have none. Where rows are nearly dependent, as those of bodies in a straight
/// line, velocities that take small errors away are so large that straight ways end farther off than they began.
template <class Real>
struct PlanLess {
  static constexpr const char* name = "plan_less";
  JointPlaces places;
  Span<const Index> order;  ///< joint of each row
  Span<const JointRow<Real>> planned;
  Real share = 0;
  Real give = 0;  ///< by which rows give way to impulses, in parts of the mobility of their joint
  Span<JointRow<Real>> row;  ///< out

  SCREE_HD void operator()(Index k) const {
    JointRow<Real> r = planned[k];
    const unsigned held = places.joints[order[k]].held;
    for (int i = 0; i < kJointRows; ++i)
      if ((held >> i & 1u) != 0) r.bias[i] *= share;
    // Limits that ask for a way back. They and the velocity of the row count from that of the motor, with the drift.
    const Real at_rest = r.inverse_pivot(kJointAxisRow) * r.bias[kJointAxisRow];
    if (r.fastest < at_rest) r.fastest = at_rest + share * (r.fastest - at_rest);
    if (r.slowest > at_rest) r.slowest = at_rest + share * (r.slowest - at_rest);
    r.give = give * r.scale;
    row[k] = r;
  }
};

}  // namespace scree
