#pragma once
// Element programs that turn the joints of a scene into those of a step, and their impulses back.
// docs/theory.md, section "Joints".

#include "kernels/backend/backend.h"
#include "kernels/bodies/body_view.h"
#include "kernels/bodies/locks.h"
#include "kernels/contact/contact_problem.h"
#include "kernels/contact/joint_row.h"
#include "kernels/math/dense.h"
#include "kernels/math/pair_key.h"
#include "kernels/step/joint_measure.h"
#include "kernels/step/joint_recovery.h"

namespace scree {

/// In place of a body's id: the world, which rests.
inline constexpr Index kWorldId = -1;

/// What drives a joint along or about its axis. Angles, ways and speeds are those of the second body
/// against the first, from the start; of a line, those of its length beyond `zero`.
struct JointDrive {
  double lower = -INFINITY;  ///< limits [m or rad]
  double upper = INFINITY;
  double target =
      0;  ///< speed that the motor keeps [m/s or rad/s]; of a spring, where it rests [m or rad]
  double stiffness = 0;  ///< of a spring [N/m or N m/rad]; without it and damping a motor
  double damping = 0;    ///< [N s/m or N m s/rad]
  double most = 0;       ///< that motor or spring give [N or N m]; zero: there is none
  double force = 0;      ///< that a motor gives beside them whatever the speed [N or N m]
  double friction = 0;   ///< that friction gives at most [N or N m]; of form `rub` in any direction
  double share = 1;      ///< of the mobility of a spring, what the joints about it leave

  SCREE_HD bool is_used() const {
    return lower > -INFINITY || upper < INFINITY || most > 0 || force != 0 || friction > 0;
  }
};

/// A joint in the frames of its two bodies; that of the world is the world frame.
struct JointFrames {
  Index body[2] = {kWorldId, kWorldId};  ///< ids
  Vec3<double> anchor[2];                ///< center of mass to the anchor, body frame [m]
  Quat<double> frame[2];                 ///< axes of the joint to those of the body
  JointForm form = JointForm::point;
  unsigned held = 0;  ///< rows that it has, see JointRow
  double zero = 0;    ///< position that counts as zero [m]
  double reach = 0;   ///< what turns with its bodies is no farther away [m]
  JointDrive drive;
  double break_force = INFINITY;   ///< a joint that carries more is no more [N]
  double break_moment = INFINITY;  ///< [N m]
  Index turn_of = -1;  ///< joint that this is a drive about an axis of; -1: a joint of its own
};

/// What a joint remembers from step to step.
struct JointState {
  double position = 0;  ///< along or about its axis at the start of the step [m or rad]
  Index is_broken = 0;
  Index has_moved = 0;  ///< a step was taken from there, with the velocities that bodies have since
};

/// Impulse of a joint on the second of its bodies, world frame.
template <class Real>
struct JointImpulse {
  Vec3<Real> force;   ///< at the anchor of that body [N s]
  Vec3<Real> moment;  ///< about it [N m s]
};

/// place[id] = storage index of the bodies that joints may name.
struct FindPlaces {
  static constexpr const char* name = "find_places";
  BodyRanges bodies;
  Span<const Index> id;  ///< [body storage]
  Span<Index> place;     ///< [ids that joints may name] out
  SCREE_HD void operator()(Index i) const {
    if (bodies.exists(i) && id[i] < place.size) place[id[i]] = i;
  }
};

/// The bodies of joints in storage.
struct JointPlaces {
  Span<const JointFrames> joints;
  Span<const Index> place;  ///< storage index by id; kNowhere: another rank has the body
  Index world = 0;          ///< that of the world: behind all bodies
  Index moving_count = 0;

  static constexpr Index kNowhere = -1;

  SCREE_HD Index of(Index id) const { return id == kWorldId ? world : place[id]; }
  SCREE_HD bool moves(Index place) const { return place >= 0 && place < moving_count; }
  /// Whether A of the problem is the second body of the joint: where the first one does not move. Where both do, A is the first
  /// one wherever they are in storage, which differs between ranks that have them.
  SCREE_HD bool is_turned(Index joint) const { return !(of(joints[joint].body[0]) < moving_count); }
};

/// Sort keys of joints: their bodies, that of A first. Those without an owned body come behind all others.
struct JointKeys {
  static constexpr const char* name = "joint_keys";
  JointPlaces places;
  Index owned_count = 0;
  Span<std::uint64_t> key;  ///< out
  Span<Index> order;        ///< out: the joint itself

  SCREE_HD void operator()(Index j) const {
    const int a = places.is_turned(j) ? 1 : 0;
    const Index first = places.of(places.joints[j].body[a]);
    const Index second = places.of(places.joints[j].body[1 - a]);
    const bool is_here = is_owned(first) || is_owned(second);
    key[j] =
        is_here ? make_key(first, static_cast<std::uint32_t>(second)) : make_key(places.world, 0);
    order[j] = j;
  }

 private:
  SCREE_HD bool is_owned(Index place) const { return place >= 0 && place < owned_count; }
};

/// To count the joints with an owned body.
struct KeyIsBelow {
  static constexpr const char* name = "joint_is_here";
  Span<const std::uint64_t> key;
  std::uint64_t end = 0;
  SCREE_HD Sums<1> operator()(Index k) const { return {{key[k] < end ? 1.0 : 0.0}}; }
};

/// Marks the joints whose impulses and states this rank tells of, where several have them.
struct MarkCountedJoints {
  static constexpr const char* name = "mark_counted_joints";
  BodyRanges bodies;
  Span<const Index> body_a, body_b;  ///< of each row
  Span<const Index> order;           ///< joint of each row
  Span<Index> is_counted;            ///< of each joint, out
  SCREE_HD void operator()(Index k) const {
    is_counted[order[k]] = bodies.counts(body_a[k], body_b[k]) ? 1 : 0;
  }
};

/// A side where its body has a given pose; velocities are left out.
template <class Real>
SCREE_HD JointSide side_at(const BodyView<Real>& bodies, const JointPlaces& places,
                           const JointFrames& joint, int which, const Vec3<double>& position,
                           const Quat<Real>& orientation) {
  JointSide s;
  s.body = places.of(joint.body[which]);
  const Quat<double> q = normalized(Quat<double>(orientation));
  s.position = position;
  s.arm = rotate(q, joint.anchor[which]);
  s.frame = q * joint.frame[which];
  s.is_free = bodies.moves(s.body);
  if (s.is_free) s.radius = bodies.radius[s.body];
  return s;
}

/// A side where its body is.
template <class Real>
SCREE_HD JointSide side_of_joint(const BodyView<Real>& bodies, const JointPlaces& places,
                                 const JointFrames& joint, int which) {
  const Index i = places.of(joint.body[which]);
  if (i != places.world)
    return side_at(bodies, places, joint, which, bodies.position[i], bodies.orientation[i]);
  JointSide s;
  s.body = i;
  s.arm = joint.anchor[which];
  s.frame = joint.frame[which];
  return s;
}

/// From the anchor of the second body of a joint to where its forces act, which is that of B of the problem. They differ by the way
/// of a slide whose A is the second body.
/// @param position  of the joint [m]
/// @param axis      unit, world
SCREE_HD inline Vec3<double> from_second_anchor(const JointFrames& joint, bool is_turned,
                                                double position, const Vec3<double>& axis) {
  if (!is_turned || joint.form != JointForm::slide) return {};
  return -(position + joint.zero) * axis;
}

/// -1: A of the problem is the second body of the joint, and its position is not the same both ways.
SCREE_HD inline double sign_of_joint(const JointFrames& joint, bool is_turned) {
  return is_turned && !is_symmetric(joint.form) ? -1 : 1;
}

/// Where the limits of a joint are, as the problem sees it: along from A to B.
struct JointBounds {
  double lower = -INFINITY, upper = INFINITY;  ///< [m or rad]

  SCREE_HD bool are_there() const { return lower > -INFINITY || upper < INFINITY; }
  /// By how much a position is beyond them.
  SCREE_HD double beyond(double x) const {
    return x > upper ? x - upper : (x < lower ? lower - x : 0);
  }
};
SCREE_HD inline JointBounds bounds_of_joint(const JointDrive& drive, double sign) {
  if (sign > 0) return {drive.lower, drive.upper};
  return {-drive.upper, -drive.lower};
}

/// A value in the precision of a run; what is too large for it has no bound.
template <class Real>
SCREE_HD Real limited_value(double value) {
  constexpr double kMost = static_cast<double>(largest_number<Real>());
  return static_cast<Real>(value > kMost ? kMost : (value < -kMost ? -kMost : value));
}

/// What the set-up of joints adds up.
struct JointSums {
  double max_error = 0;  ///< distance of two anchors, or turn times length, that should be zero [m]
  Index max_error_joint = -1;  ///< the first of those with that error; -1: none has one
  /// Longest way of a point of a body back to where a limit is passed no more [m].
  double way_back = 0;
  double end_error = 0;  ///< at the end of the step, with what limits are passed by then [m]
  /// Of the fastest point of a free body, as of a ball, at the start and at the end [m/s].
  double speed_before = 0, speed = 0;
  /// Of the free bodies, once for each of their joints: without joints and contacts, at the end, and their mass [J, kg].
  double free_energy = 0, energy = 0, mass = 0;
  double driven = 0;  ///< largest speed that a drive or a prescribed body asks for [m/s]
  double forced = 0;  ///< the same without drives of bounded force [m/s]
  double left = 0;    ///< largest velocity of a row that should have none [m/s]
  SCREE_HD void combine(const JointSums& o) {
    const bool is_first = o.max_error == max_error && o.max_error_joint < max_error_joint;
    if (o.max_error > max_error || is_first) {
      max_error = o.max_error;
      max_error_joint = o.max_error_joint;
    }
    if (o.way_back > way_back) way_back = o.way_back;
    if (o.end_error > end_error) end_error = o.end_error;
    if (o.speed_before > speed_before) speed_before = o.speed_before;
    if (o.speed > speed) speed = o.speed;
    free_energy += o.free_energy;
    energy += o.energy;
    mass += o.mass;
    if (o.driven > driven) driven = o.driven;
    if (o.forced > forced) forced = o.forced;
    if (o.left > left) left = o.left;
  }
};

/// Joint k of the problem: rows, bias and warm start.
///
/// Two anchors are `gap` apart, the axes off by the angle `turn`. The bias takes both away within
/// the step, no faster than the recovery speed; and as bodies turn by h w in it,
///   anchors move by   h w x r + h^2/2 (w' x r + w x (w x r)),   I w' = I w x w
///   axes turn by      h (w_b - w_a) + h^2/2 (w_b x w_a + w'_b - w'_a)
/// so the second terms over h, with the present w, are part of it (JointDrift): position errors are
/// of third order, and impulses act as those of the Verlet scheme do.
template <class Real>
struct JointSetup {
  static constexpr const char* name = "joint_setup";
  BodyView<Real> bodies;
  Span<const GeneralInertia<Real>> inertia;  ///< [bodies.count]
  JointPlaces places;
  Span<const Index> order;                ///< joint of each row
  Span<const JointImpulse<Real>> before;  ///< of each joint, in the step before
  Span<JointState> state;                 ///< of each joint, in and out
  Vec3<double> period;                    ///< zero: axis not periodic [m]
  double time_step = 0;                   ///< h [s]
  double recovery_speed = 0;              ///< [m/s]
  bool is_measured = false;               ///< the positions in `state` are of this step already
  Span<Index> body_a;                     ///< out, like the rest
  Span<Index> body_b;
  Span<Vec3<Real>> normal;  ///< the axis: that of a contact has no meaning here
  Span<JointRow<Real>> row;
  Span<Vec3<Real>> gamma;  ///< two vectors a joint, in the coordinates of solvers [N s]

  SCREE_HD JointSums operator()(Index k) const {
    const Index j = order[k];
    const JointFrames& joint = places.joints[j];
    const bool turned = places.is_turned(j);
    const bool is_broken = state[j].is_broken != 0;
    JointSide a = side(joint, turned ? 1 : 0);
    const JointSide b = side(joint, turned ? 0 : 1);
    body_a[k] = a.body;
    body_b[k] = b.body;

    JointMeasure m =
        measure_joint(form_of_sides(joint.form, turned), joint.held, joint.zero, a, b, period);
    const double sign = sign_of_joint(joint, turned);
    const double since = state[j].has_moved != 0 && !is_measured ? time_step : 0;
    const double turned_by = since * turning_about_axis(m.frame, a.turning, b.turning) / m.gear;
    const double expected = state[j].position + sign * turned_by;
    double position = joint_position(joint.form, m, sign, joint.zero, expected);
    state[j].position = position;
    state[j].has_moved = 1;
    if (joint.form == JointForm::swing) {
      look_ahead(m, a, b, time_step);
      position = m.position;
    }
    const JointDrift drift = drift_of_joint(joint.form, m, a, b, time_step);
    const bool is_last_held = (joint.held >> kJointAxisRow & 1u) != 0;

    const double length = length_of_joint(a, b);
    const double half = 0.5 * time_step;
    const Vec3<double> linear =
        joint_recovery(m.gap, 1, time_step, recovery_speed) + half * drift.linear;
    const Vec3<double> angular =
        joint_recovery(m.turn, length, time_step, recovery_speed) + (half * length) * drift.angular;

    JointRow<Real> r;
    r.force_is_last = ends_with_force(joint.form);
    r.arm_a = Vec3<Real>(a.arm);
    r.arm_b = Vec3<Real>(b.arm);
    r.rubs = joint.form == JointForm::rub;
    r.axes[0] = Vec3<Real>(rotate(m.frame, {1, 0, 0}));
    r.axes[1] = Vec3<Real>(rotate(m.frame, {0, 1, 0}));
    r.axes[2] = Vec3<Real>(rotate(m.frame, {0, 0, 1}));
    if (r.rubs) principal_axes(a, b, r.axes);
    r.length = static_cast<Real>(length);
    if (!r.rubs) r.bias = r.rows(Vec3<Real>(linear), Vec3<Real>(angular));
    double block[kJointTriangle] = {};
    add_block(r, a, block);
    add_block(r, b, block);
    const bool is_driven = !is_last_held && joint.drive.is_used();
    const unsigned driven_rows = is_driven ? (r.rubs ? kJointMoments : 1u << kJointAxisRow) : 0u;
    factorize(r, block, is_broken ? 0u : joint.held | driven_rows);
    r.most = r.rubs ? 0 : largest_number<Real>();
    r.least = -r.most;
    JointSums sums;
    if (r.rubs) {
      r.friction = limited_value<Real>(time_step * joint.drive.friction / length);
    } else if (is_driven) {
      sums.max_error = drive(joint.drive, m.gear, sign, position, a, b, r);
      sums.way_back = sums.max_error / share_of_points(r, a, b);
    }
    row[k] = r;
    normal[k] = r.axes[2];

    const JointImpulse<Real>& last = before[j];
    const Real side_sign = turned ? Real(-1) : Real(1);
    const Vec3<Real> offset(
        from_second_anchor(joint, turned, position, rotate(m.frame, {0, 0, 1})));
    const Vec3<Real> moment = last.moment - cross(offset, last.force);
    const JointValues<Real> z =
        r.scaled_impulse(r.rows(side_sign * last.force, (side_sign / r.length) * moment));
    gamma[2 * static_cast<Offset>(k)] = {z[0], z[1], z[2]};
    gamma[2 * static_cast<Offset>(k) + 1] = {z[3], z[4], z[5]};

    if (is_broken) return {};
    if (norm(m.gap) > sums.max_error) sums.max_error = norm(m.gap);
    const bool is_turn_held = (joint.held >> 3) != 0;
    const double tilt = is_turn_held ? length * norm(m.turn) : 0;
    if (tilt > sums.max_error) sums.max_error = tilt;
    if (sums.max_error > 0) sums.max_error_joint = j;
    return sums;
  }

 private:
  static SCREE_HD Sym3<double> widened(const Sym3<Real>& m) {
    Sym3<double> w;
    w.xx = m.xx, w.yy = m.yy, w.zz = m.zz;
    w.xy = m.xy, w.xz = m.xz, w.yz = m.yz;
    return w;
  }

  SCREE_HD JointSide side(const JointFrames& joint, int which) const {
    JointSide s = side_of_joint(bodies, places, joint, which);
    if (s.body == places.world) return s;
    s.velocity = Vec3<double>(bodies.velocity[s.body]);
    s.turning = Vec3<double>(bodies.angular_velocity[s.body]);
    if (!s.is_free) return s;
    const unsigned axes = free_angular_axes(bodies.locks[s.body]);
    const GeneralInertia<Real>& own = inertia[s.body];
    s.turning = on_axes(s.turning, axes);
    s.inv_mass = Vec3<double>(own.inv_mass);
    s.inv_inertia = widened(own.inv_inertia);
    if (axes == 7u)
      s.acceleration = s.inv_inertia * cross(widened(own.inertia) * s.turning, s.turning);
    return s;
  }

  /// Axes in which moments between two bodies do not act on each other.
  static SCREE_HD void principal_axes(const JointSide& a, const JointSide& b, Vec3<Real>* axes) {
    Dense<3> sum, own;
    for (int side = 0; side < 2; ++side) {
      const JointSide& s = side == 0 ? a : b;
      if (!s.is_free) continue;
      for (int k = 0; k < 3; ++k) {
        Vec3<double> unit;
        unit[k] = 1;
        const Vec3<double> column = s.inv_inertia * unit;
        for (int i = 0; i < 3; ++i) sum(i, k) += column[i];
      }
    }
    diagonalize(sum, own);
    for (int k = 0; k < 3; ++k) axes[k] = Vec3<Real>(Vec3<double>{own(0, k), own(1, k), own(2, k)});
  }

  /// Adds J M^-1 J^T of one body.
  static SCREE_HD void add_block(const JointRow<Real>& r, const JointSide& s,
                                 double (&block)[kJointTriangle]) {
    if (!s.is_free) return;
    Vec3<double> linear[kJointRows], angular[kJointRows];
    for (int k = 0; k < 3; ++k) {
      linear[k] = Vec3<double>(r.axes[k]);
      angular[k] = cross(s.arm, linear[k]);
      angular[3 + k] = static_cast<double>(r.length) * linear[k];
    }
    if (r.force_is_last) {
      linear[kJointAxisRow] = linear[2];
      linear[2] = {};
      const Vec3<double> along = angular[2];
      angular[2] = angular[kJointAxisRow];
      angular[kJointAxisRow] = along;
    }
    for (int i = 0; i < kJointRows; ++i) {
      const Vec3<double> moved = hadamard(s.inv_mass, linear[i]);
      const Vec3<double> spun = s.inv_inertia * angular[i];
      for (int j = 0; j <= i; ++j)
        block[triangle_place(i, j)] += dot(moved, linear[j]) + dot(spun, angular[j]);
    }
  }

  /// What the last row gives. Its main part is that of the motor, u = speed, or of the spring,
  ///   gamma = -h k (x + h (alpha u - beta u_0)) - h c u    u, u_0: mean of this step and of the last
  /// and what a motor gives at any speed shifts it.
  /// With alpha + beta >= 1/2 and alpha >= beta it is stable at any step; docs/theory.md, "Joints".
  /// @param gear      see JointMeasure
  /// @param sign      -1: A of the problem is the second body of the joint
  /// @param position  of the joint at the start of the step [m or rad]
  /// @return  how far it is beyond its limits [m]
  SCREE_HD double drive(const JointDrive& d, double gear, double sign, double position,
                        const JointSide& a, const JointSide& b, JointRow<Real>& r) const {
    const double inverse = r.inverse_pivot(kJointAxisRow), h = time_step;
    const double length = r.length;
    const double unit = r.force_is_last ? 1 : gear * length;
    const double x = sign * position;
    const JointBounds bounds = bounds_of_joint(d, sign);
    const double beyond = bounds.beyond(x);
    if (!(inverse > 0)) return unit * beyond;  // nothing can follow

    const double drift = static_cast<double>(r.bias[kJointAxisRow]);
    const double force = sign * d.force;
    double level = 0, compliance = 0;  // the main part takes the velocity to `level`
    if (d.stiffness > 0 || d.damping > 0) {
      const Vec3<double> axis(r.axes[2]);
      const double rate = r.force_is_last ? dot(axis, b.anchor_velocity() - a.anchor_velocity())
                                          : length * dot(axis, b.turning - a.turning);
      const double before = rate - drift;  // mean of the last step
      // (h w)^2 with the mass that the row moves where the others hold, and other joints.
      const double mobility =
          d.share * static_cast<double>(r.scale) / (inverse * inverse * unit * unit);
      const double rigidity = h * h * d.stiffness * mobility;
      const double share = rigidity / (1 + rigidity);
      const double alpha = 0.25 + 0.75 * share, beta = 0.25 - 0.25 * share;
      const double resistance = alpha * h * d.stiffness + d.damping;
      compliance = unit * unit / (h * resistance);
      const double ahead = unit * (x - sign * d.target) - beta * h * before;
      level = (unit * force - d.stiffness * ahead) / resistance;
    } else {
      level = sign * unit * d.target;
    }
    double fastest = unit * (bounds.upper - x) / h, slowest = unit * (bounds.lower - x) / h;
    const double most = recovery_speed * share_of_points(r, a, b);
    if (fastest < -most) fastest = -most;
    if (slowest > most) slowest = most;
    r.bias[kJointAxisRow] = static_cast<Real>(drift - level);
    // In the coordinates of solvers.
    const double impulse = h / (unit * inverse);
    r.most = limited_value<Real>(impulse * (force + d.most));
    r.least = limited_value<Real>(impulse * (force - d.most));
    r.compliance = static_cast<Real>(inverse * inverse * compliance);
    r.friction = limited_value<Real>(impulse * d.friction);
    r.rest = static_cast<Real>(inverse * (drift - level));
    r.fastest = limited_value<Real>(inverse * (fastest - level));
    r.slowest = limited_value<Real>(inverse * (slowest - level));
    return unit * beyond;
  }
};

/// Impulse of joint j from that of its row k of the problem.
template <class Real>
SCREE_HD JointImpulse<Real> impulse_of_joint(const JointPlaces& places, Index j,
                                             const JointState& state, const JointRow<Real>& row,
                                             Span<const Vec3<Real>> gamma, Index k) {
  const Vec3<Real> force = gamma[2 * static_cast<Offset>(k)];
  const Vec3<Real> moment = gamma[2 * static_cast<Offset>(k) + 1];
  const JointValues<Real> g =
      row.impulse({{force.x, force.y, force.z, moment.x, moment.y, moment.z}});
  const bool turned = places.is_turned(j);
  const Real sign = turned ? Real(-1) : Real(1);
  const Vec3<Real> on_b = sign * row.world_force(g);
  const Vec3<Real> offset(
      from_second_anchor(places.joints[j], turned, state.position, Vec3<double>(row.axes[2])));
  return {on_b, (sign * row.length) * row.world_moment(g) + cross(offset, on_b)};
}

/// Impulses of joints from those of the problem.
template <class Real>
struct KeepJointImpulses {
  static constexpr const char* name = "keep_joint_impulses";
  JointPlaces places;
  Span<const Index> order;
  Span<const JointRow<Real>> row;
  Span<const Vec3<Real>> gamma;
  double time_step = 0;                    ///< [s]
  Span<const JointImpulse<Real>> impacts;  ///< of each joint, in the impacts of the step; or empty
  Span<JointImpulse<Real>> impulse;        ///< of each joint, without those, out
  Span<JointState> state;                  ///< in and out: joints that carry too much break

  SCREE_HD void operator()(Index k) const {
    const Index j = order[k];
    const JointFrames& joint = places.joints[j];
    JointImpulse<Real> all = impulse_of_joint(places, j, state[j], row[k], gamma, k);
    impulse[j] = all;
    if (!impacts.empty()) {
      all.force += impacts[j].force;
      all.moment += impacts[j].moment;
    }
    const double h = time_step;
    if (norm(Vec3<double>(all.force)) > h * joint.break_force ||
        norm(Vec3<double>(all.moment)) > h * joint.break_moment)
      state[j].is_broken = 1;
  }
};

/// Drives about the axes of joints, which are behind these, those of a joint one after the other: they break with their joint, by
/// the moment of all.
template <class Real>
struct BreakTurns {
  static constexpr const char* name = "break_turns";
  Span<const JointFrames> joints;
  Index first = 0;                                  ///< of the drives
  double time_step = 0;                             ///< [s]
  Span<const JointImpulse<Real>> impacts, impulse;  ///< see KeepJointImpulses
  Span<JointState> state;                           ///< in and out

  SCREE_HD void operator()(Index k) const {
    const Index turn = first + k, own = joints[turn].turn_of;
    if (k > 0 && joints[turn - 1].turn_of == own) return;  // the first of a joint is for all
    Vec3<double> moment = moment_of(own);
    Index end = turn;
    for (; end < joints.size && joints[end].turn_of == own; ++end) moment += moment_of(end);
    if (norm(moment) > time_step * joints[own].break_moment) state[own].is_broken = 1;
    for (Index t = turn; t < end; ++t) state[t].is_broken = state[own].is_broken;
  }

 private:
  SCREE_HD Vec3<double> moment_of(Index j) const {
    return Vec3<double>(impacts.empty() ? impulse[j].moment
                                        : impulse[j].moment + impacts[j].moment);
  }
};

}  // namespace scree
