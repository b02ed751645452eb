#pragma once
// Where the two sides of a joint are to each other: what is off in the rows that it holds, the way
// along or about its axis, and how turning bodies change both. docs/theory.md, section "Joints".

#include "kernels/backend/backend.h"
#include "kernels/contact/joint_row.h"
#include "kernels/math/periodic.h"
#include "kernels/math/quat.h"

namespace scree {

/// What the rows of a joint measure.
///   point  two points are one; the axis belongs to both bodies. The last row turns about it
///   slide  the point of B lies on the axis through that of A. The last row goes along it
///   cross  two points are one; the axis of A is at a right angle to that of B. The last row turns
///          about the normal of both
///   line   the last row goes along the line from the point of A to that of B
///   swing  two points are one; the last row opens the angle between the axes of A and B
/// and without other rows:
///   turn         the last row turns about the axis of the first body
///   second_turn  the same about that of the second body
///   twist        the last row turns about the axis of B, with what is left of the rotation from A
///                to B after the shortest one that brings the axis there
///   rub          three moments with a bound together; there is nothing to measure
enum class JointForm : std::uint8_t {
  point,
  slide,
  cross,
  line,
  swing,
  turn,
  second_turn,
  twist,
  rub
};

/// A form as A and B of the problem have it. @param is_turned  A is the second body of the joint
SCREE_HD constexpr JointForm form_of_sides(JointForm form, bool is_turned) {
  if (is_turned && form == JointForm::turn) return JointForm::second_turn;
  if (is_turned && form == JointForm::second_turn) return JointForm::turn;
  return form;
}

/// Whether the last row is a force, see JointRow.
SCREE_HD constexpr bool ends_with_force(JointForm form) {
  return form == JointForm::slide || form == JointForm::line;
}

/// Whether the position is an angle that counts whole turns.
SCREE_HD constexpr bool counts_turns(JointForm form) {
  return form == JointForm::point || form == JointForm::turn || form == JointForm::second_turn ||
         form == JointForm::twist;
}

/// Whether the position is the same from B to A as from A to B.
SCREE_HD constexpr bool is_symmetric(JointForm form) {
  return form == JointForm::line || form == JointForm::swing;
}

/// One of the two bodies of a joint.
struct JointSide {
  Index body = 0;  ///< in storage
  bool is_free = false;
  Vec3<double> position;      ///< of the center of mass [m]
  Vec3<double> arm;           ///< from there to the anchor [m]
  Quat<double> frame;         ///< axes of the joint to those of the world
  Vec3<double> velocity;      ///< [m/s]
  Vec3<double> turning;       ///< w [rad/s]
  Vec3<double> acceleration;  ///< w' of free rotation [rad/s^2]
  double radius = INFINITY;   ///< of the sphere about a free body [m]
  Vec3<double> inv_mass;
  Sym3<double> inv_inertia;

  /// Acceleration of the anchor while the body turns freely [m/s^2].
  SCREE_HD Vec3<double> centripetal() const {
    return cross(acceleration, arm) + cross(turning, cross(turning, arm));
  }
  SCREE_HD Vec3<double> anchor_velocity() const { return velocity + cross(turning, arm); }
};

/// A rotation that takes the z axis to a unit vector.
SCREE_HD inline Quat<double> rotation_to(const Vec3<double>& axis) {
  if (axis.z < -0.5) {  // by way of the opposite vector: near it no digits are lost
    return normalized(Quat<double>{1 - axis.z, axis.y, -axis.x, 0}) * Quat<double>{0, 1, 0, 0};
  }
  return normalized(Quat<double>{1 + axis.z, -axis.y, axis.x, 0});
}

struct JointMeasure {
  Quat<double> frame;   ///< axes of the joint to those of the world
  Vec3<double> gap;     ///< from where B should be to where it is, as far as forces hold it [m]
  Vec3<double> turn;    ///< rotation vector from A to B, as far as moments hold it [rad]
  double position = 0;  ///< along or about the axis, from A to B [m or rad]
  double gear = 1;      ///< turning about the axis of `frame` over the speed of the position
  bool looks_ahead = false;  ///< see look_ahead()
};

/// Rotation vector from the axes on A to those on B, for small angles [rad]: the tilt of the axis
/// and, where that is held, the angle about it.
SCREE_HD inline double angle_about_axis(const JointSide& a, const JointSide& b) {
  const Quat<double> q = conjugate(a.frame) * b.frame;
  return 2 * std::atan2(q.w < 0 ? -q.z : q.z, std::abs(q.w));
}
/// By how much the first of the other axes on B is turned about an axis against that on A [rad].
SCREE_HD inline double angle_across(const JointSide& a, const JointSide& b,
                                    const Vec3<double>& axis) {
  const Vec3<double> from = rotate(a.frame, {1, 0, 0}), to = rotate(b.frame, {1, 0, 0});
  return std::atan2(dot(axis, cross(from, to)), dot(from, to) - dot(axis, from) * dot(axis, to));
}
SCREE_HD inline Vec3<double> misalignment(const JointSide& a, const JointSide& b,
                                          const Vec3<double>& axis, bool is_angle_held) {
  const Vec3<double> tilt = cross(axis, rotate(b.frame, {0, 0, 1}));
  return is_angle_held ? tilt + angle_about_axis(a, b) * axis : tilt;
}

/// @param form    see form_of_sides()
/// @param a       of a slide its arm goes to the anchor of B afterwards: A holds that point
/// @param held    rows that the joint has, see JointRow
/// @param zero    length of a line [m]
/// @param period  zero: axis not periodic [m]
SCREE_HD inline JointMeasure measure_joint(JointForm form, unsigned held, double zero, JointSide& a,
                                           const JointSide& b, const Vec3<double>& period) {
  JointMeasure m;
  m.frame = a.frame;
  m.gap = minimum_image(b.position + b.arm - a.position - a.arm, period);
  const Vec3<double> axis = rotate(a.frame, {0, 0, 1});
  switch (form) {
    case JointForm::point:
      m.turn = misalignment(a, b, axis, (held >> kJointAxisRow & 1u) != 0);
      m.position = angle_about_axis(a, b);
      break;
    case JointForm::slide:
      a.arm += m.gap;
      m.position = dot(axis, m.gap);
      m.gap -= m.position * axis;
      m.turn = misalignment(a, b, axis, (held >> 2 & 1u) != 0);
      break;
    case JointForm::cross: {
      const Vec3<double> other = rotate(b.frame, {0, 0, 1});
      const Vec3<double> normal = cross(axis, other);
      const double sine = norm(normal);
      if (!(sine > 0)) break;  // the two axes are one: no moment holds them apart
      m.frame = rotation_to((1 / sine) * normal);
      m.position = -std::atan2(dot(axis, other), sine);
      m.turn = (m.position / sine) * normal;
      break;
    }
    case JointForm::line:
      m.position = norm(m.gap);
      if (m.position > 0) m.frame = rotation_to((1 / m.position) * m.gap);
      m.gap = {};
      if ((held >> kJointAxisRow & 1u) != 0)
        m.gap = (m.position - zero) * rotate(m.frame, {0, 0, 1});
      break;
    case JointForm::swing: {
      const Vec3<double> other = rotate(b.frame, {0, 0, 1}), normal = cross(axis, other);
      const double sine = norm(normal);
      m.position = std::atan2(sine, dot(axis, other));
      m.frame = rotation_to(sine > 0 ? (1 / sine) * normal : rotate(a.frame, {1, 0, 0}));
      break;
    }
    case JointForm::turn:
    case JointForm::second_turn:
      m.gap = {};
      if (form == JointForm::second_turn) m.frame = b.frame;
      m.position = angle_across(a, b, rotate(m.frame, {0, 0, 1}));
      break;
    case JointForm::twist: {
      constexpr double kLeastGear =
          1e-3;  // axes that are nearly opposite: what is left means nothing
      m.gap = {};
      m.position = angle_about_axis(a, b);
      const Vec3<double> middle = axis + rotate(b.frame, {0, 0, 1});
      m.gear = 0.5 * norm(middle);
      if (m.gear > kLeastGear) {
        m.frame = rotation_to((0.5 / m.gear) * middle);
      } else {
        m.gear = kLeastGear;
      }
      break;
    }
    case JointForm::rub:
      m.gap = {};
      break;
  }
  return m;
}

/// Where the axes of a swing are so near to each other that bodies take them far aside in a step, the row goes the way that they
/// will be apart, not the way that they are, and the position along it is what is measured: a narrow cone is a disk there.
SCREE_HD inline void look_ahead(JointMeasure& swing, const JointSide& a, const JointSide& b,
                                double time_step) {
  constexpr double kNear = 0.3, kFar = 0.1;  // where a sphere is flat; a way beside an angle
  const Vec3<double> axis = rotate(a.frame, {0, 0, 1}), turning = b.turning - a.turning;
  const Vec3<double> way = time_step * (turning - dot(turning, axis) * axis);
  if (swing.position > kNear || !(norm(way) > kFar * swing.position)) return;
  const Vec3<double> normal = rotate(swing.frame, {0, 0, 1});
  const Vec3<double> ahead = swing.position * normal + way;
  const double size = norm(ahead);
  if (!(size > 0)) return;
  swing.position *= dot(normal, ahead) / size;
  swing.frame = rotation_to((1 / size) * ahead);
  swing.looks_ahead = true;
}

/// How fast B turns about the axis of a joint against A [rad/s]. @param frame  of JointMeasure
SCREE_HD inline double turning_about_axis(const Quat<double>& frame, const Vec3<double>& turning_a,
                                          const Vec3<double>& turning_b) {
  return dot(rotate(frame, {0, 0, 1}), turning_b - turning_a);
}

/// The position of a joint, from its measure: angles count whole turns, and the one nearest to what is expected is meant.
/// @param sign      -1: A of the problem is the second body of the joint, but for a line
/// @param zero      position that counts as zero [m]
/// @param expected  position, by the one before and how fast it has turned since [m or rad]
SCREE_HD inline double joint_position(JointForm form, const JointMeasure& m, double sign,
                                      double zero, double expected) {
  constexpr double kTurn = 6.283185307179586477;
  const double position = sign * m.position - zero;
  if (!counts_turns(form)) return position;
  return position + kTurn * std::rint((expected - position) / kTurn);
}

/// Second derivatives of what the rows measure while the bodies turn freely.
struct JointDrift {
  Vec3<double> linear;   ///< [m/s^2]
  Vec3<double> angular;  ///< [rad/s^2]
};

/// @param a, b       as measure_joint() leaves them
/// @param time_step  [s]
SCREE_HD inline JointDrift drift_of_joint(JointForm form, const JointMeasure& m, const JointSide& a,
                                          const JointSide& b, double time_step) {
  JointDrift d;
  d.linear = b.centripetal() - a.centripetal();
  d.angular = cross(b.turning, a.turning) + b.acceleration - a.acceleration;
  const Vec3<double> axis = rotate(m.frame, {0, 0, 1});
  switch (form) {
    case JointForm::point:
    case JointForm::turn:
    case JointForm::second_turn:
    case JointForm::rub:
      break;
    case JointForm::swing: {  // the way across opens the angle, as on a sphere
      const Vec3<double> x = rotate(a.frame, {0, 0, 1}), y = rotate(b.frame, {0, 0, 1});
      const Vec3<double> turning = b.turning - a.turning;
      const double across = dot(cross(turning, y), axis), way = time_step * across;
      const double sine = norm(cross(x, y)), cosine = dot(x, y);
      const double whole = std::sqrt(sine * sine + way * way * cosine * cosine) + sine;
      const double wider = whole > 0 && !m.looks_ahead ? way * way * cosine / whole : 0;
      d.angular += (2 * wider / (time_step * time_step) - across * dot(turning, y)) * axis;
      break;
    }
    case JointForm::twist: {  // the gear changes as the angle between the axes does
      const Vec3<double> x = rotate(a.frame, {0, 0, 1}), y = rotate(b.frame, {0, 0, 1});
      const Vec3<double> turning = b.turning - a.turning;
      const double opening = dot(cross(x, y), turning) / (2 * m.gear * m.gear);
      d.angular += opening * dot(axis, turning) * axis;
      break;
    }
    case JointForm::slide:  // Coriolis, in the frame of A
      d.linear -= 2.0 * cross(a.turning, b.anchor_velocity() - a.anchor_velocity());
      break;
    case JointForm::cross: {  // second derivative of the product of the two axes
      const Vec3<double> x = rotate(a.frame, {0, 0, 1}), y = rotate(b.frame, {0, 0, 1});
      const Vec3<double> x1 = cross(a.turning, x), y1 = cross(b.turning, y);
      const Vec3<double> x2 = cross(a.acceleration, x) + cross(a.turning, x1);
      const Vec3<double> y2 = cross(b.acceleration, y) + cross(b.turning, y1);
      d.angular = -(dot(x2, y) + 2 * dot(x1, y1) + dot(x, y2)) * axis;
      break;
    }
    case JointForm::line: {  // the way across makes the distance longer
      const Vec3<double> v = b.anchor_velocity() - a.anchor_velocity();
      const double across = norm(v - dot(axis, v) * axis);
      const double way = time_step * across;
      const double longer = std::sqrt(m.position * m.position + way * way) - m.position;
      d.linear = (dot(axis, d.linear) + 2 * longer / (time_step * time_step)) * axis;
      break;
    }
  }
  return d;
}

}  // namespace scree
