#pragma once
// Element programs that turn the joints of a scene into those of a step, and their impulses back.
// docs/theory.md, section "Joints".

#include "kernels/backend/backend.h"
#include "kernels/bodies/body_view.h"
#include "kernels/bodies/locks.h"
#include "kernels/contact/contact_problem.h"
#include "kernels/contact/joint_row.h"
#include "kernels/math/pair_key.h"
#include "kernels/math/periodic.h"

namespace scree {

/// In place of a body's id: the world, which rests.
inline constexpr Index kWorldId = -1;

/// A joint in the frames of its two bodies; that of the world is the world frame.
struct JointFrames {
  Index body[2] = {kWorldId, kWorldId};  ///< ids
  Vec3<double> anchor[2];                ///< center of mass to the anchor, body frame [m]
  Quat<double> frame[2];                 ///< axes of the joint to those of the body
  unsigned held = 0;                     ///< rows that it has, see JointRow
};

/// Impulse of a joint on the second of its bodies, world frame.
template <class Real>
struct JointImpulse {
  Vec3<Real> force;   ///< at the anchor [N s]
  Vec3<Real> moment;  ///< [N m s]
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
  Span<const Index> place;  ///< storage index by id
  Index world = 0;          ///< that of the world: behind all bodies

  SCREE_HD Index of(Index id) const { return id == kWorldId ? world : place[id]; }
  /// Whether A of the problem, the body that comes first in storage, is the second of the joint.
  SCREE_HD bool is_turned(Index joint) const {
    return of(joints[joint].body[1]) < of(joints[joint].body[0]);
  }
};

/// Sort keys of joints: their bodies, the first in storage first.
struct JointKeys {
  static constexpr const char* name = "joint_keys";
  JointPlaces places;
  Span<std::uint64_t> key;  ///< out
  Span<Index> order;        ///< out: the joint itself
  SCREE_HD void operator()(Index j) const {
    const Index first = places.of(places.joints[j].body[0]);
    const Index second = places.of(places.joints[j].body[1]);
    key[j] = first < second ? make_key(first, static_cast<std::uint32_t>(second))
                            : make_key(second, static_cast<std::uint32_t>(first));
    order[j] = j;
  }
};

/// What the set-up of joints adds up.
struct JointSums {
  double max_error = 0;  ///< distance of two anchors, or turn times length, that should be zero [m]
  SCREE_HD void combine(const JointSums& o) {
    if (o.max_error > max_error) max_error = o.max_error;
  }
};

/// Joint k of the problem: rows, bias and warm start.
///
/// Two anchors are `gap` apart, the axes off by the angle `turn`. The bias takes both away within
/// the step, no faster than the recovery speed; and as bodies turn by h w in it,
///   anchors move by   h w x r + h^2/2 (w' x r + w x (w x r)),   I w' = I w x w
///   axes turn by      h (w_b - w_a) + h^2/2 (w_b x w_a + w'_b - w'_a)
/// so the second terms over h, with the present w, are part of it: position errors are of third
/// order, and impulses act as those of the Verlet scheme do.
template <class Real>
struct JointSetup {
  static constexpr const char* name = "joint_setup";
  BodyView<Real> bodies;
  Span<const GeneralInertia<Real>> inertia;  ///< [bodies.count]
  JointPlaces places;
  Span<const Index> order;                ///< joint of each row
  Span<const JointImpulse<Real>> before;  ///< of each joint, in the step before
  Vec3<double> period;                    ///< zero: axis not periodic [m]
  double time_step = 0;                   ///< h [s]
  double recovery_speed = 0;              ///< [m/s]
  Span<Index> body_a;                     ///< out, like the rest
  Span<Index> body_b;
  Span<Vec3<Real>> normal;  ///< the axis: that of a contact has no meaning here
  Span<JointRow<Real>> row;
  Span<Vec3<Real>> gamma;  ///< two vectors a joint, in the coordinates of solvers [N s]

  SCREE_HD JointSums operator()(Index k) const {
    const Index j = order[k];
    const JointFrames& joint = places.joints[j];
    const bool turned = places.is_turned(j);
    const Side a = side(joint, turned ? 1 : 0), b = side(joint, turned ? 0 : 1);
    body_a[k] = a.body;
    body_b[k] = b.body;

    const Vec3<double> axis = rotate(a.frame, {0, 0, 1});
    const Vec3<double> gap = minimum_image(b.position + b.arm - a.position - a.arm, period);
    const Vec3<double> turn = misalignment(a, b, axis, (joint.held >> kJointAxisRow & 1u) != 0);
    const double length = b.is_free && b.radius < a.radius ? b.radius : a.radius;
    const double half = 0.5 * time_step;
    const Vec3<double> linear = recovery(gap, 1) + half * (b.centripetal() - a.centripetal());
    const Vec3<double> angular =
        recovery(turn, length) +
        (half * length) * (cross(b.turning, a.turning) + b.acceleration - a.acceleration);

    JointRow<Real> r;
    r.arm_a = Vec3<Real>(a.arm);
    r.arm_b = Vec3<Real>(b.arm);
    r.axes[0] = Vec3<Real>(rotate(a.frame, {1, 0, 0}));
    r.axes[1] = Vec3<Real>(rotate(a.frame, {0, 1, 0}));
    r.axes[2] = Vec3<Real>(axis);
    r.length = static_cast<Real>(length);
    r.bias = r.rows(Vec3<Real>(linear), Vec3<Real>(angular));
    double block[kJointTriangle] = {};
    add_block(r, a, block);
    add_block(r, b, block);
    factorize(r, block, joint.held);
    r.most = largest_number();
    r.least = -r.most;
    row[k] = r;
    normal[k] = r.axes[2];

    const JointImpulse<Real>& last = before[j];
    const Real sign = turned ? Real(-1) : Real(1);
    const JointValues<Real> z =
        r.scaled_impulse(r.rows(sign * last.force, (sign / r.length) * last.moment));
    gamma[2 * static_cast<Offset>(k)] = {z[0], z[1], z[2]};
    gamma[2 * static_cast<Offset>(k) + 1] = {z[3], z[4], z[5]};

    JointSums sums;
    sums.max_error = norm(gap);
    const bool is_axis_held = (joint.held >> 3 & 3u) != 0;
    const double tilt = is_axis_held ? length * norm(turn) : 0;
    if (tilt > sums.max_error) sums.max_error = tilt;
    return sums;
  }

 private:
  /// One of the two bodies.
  struct Side {
    Index body = 0;
    bool is_free = false;
    Vec3<double> position;      ///< of the center of mass [m]
    Vec3<double> arm;           ///< [m]
    Quat<double> frame;         ///< axes of the joint to those of the world
    Vec3<double> turning;       ///< w [rad/s]
    Vec3<double> acceleration;  ///< w' of free rotation [rad/s^2]
    double radius = INFINITY;   ///< of the sphere about a free body [m]
    Vec3<double> inv_mass;
    Sym3<double> inv_inertia;

    /// Acceleration of the anchor while the body turns freely [m/s^2].
    SCREE_HD Vec3<double> centripetal() const {
      return cross(acceleration, arm) + cross(turning, cross(turning, arm));
    }
  };

  static SCREE_HD Sym3<double> widened(const Sym3<Real>& m) {
    Sym3<double> w;
    w.xx = m.xx, w.yy = m.yy, w.zz = m.zz;
    w.xy = m.xy, w.xz = m.xz, w.yz = m.yz;
    return w;
  }

  SCREE_HD Side side(const JointFrames& joint, int which) const {
    Side s;
    s.body = places.of(joint.body[which]);
    s.arm = joint.anchor[which];
    s.frame = joint.frame[which];
    if (s.body == places.world) return s;
    const Quat<double> q = normalized(Quat<double>(bodies.orientation[s.body]));
    s.position = bodies.position[s.body];
    s.arm = rotate(q, s.arm);
    s.frame = q * s.frame;
    s.turning = Vec3<double>(bodies.angular_velocity[s.body]);
    s.is_free = bodies.moves(s.body);
    if (!s.is_free) return s;
    const unsigned axes = free_angular_axes(bodies.locks[s.body]);
    const GeneralInertia<Real>& own = inertia[s.body];
    s.turning = on_axes(s.turning, axes);
    s.radius = bodies.radius[s.body];
    s.inv_mass = Vec3<double>(own.inv_mass);
    s.inv_inertia = widened(own.inv_inertia);
    if (axes == 7u)
      s.acceleration = s.inv_inertia * cross(widened(own.inertia) * s.turning, s.turning);
    return s;
  }

  /// Rotation vector from the axes on A to those on B, for small angles [rad]: the tilt of the axis
  /// and, where that is held, the angle about it.
  static SCREE_HD Vec3<double> misalignment(const Side& a, const Side& b, const Vec3<double>& axis,
                                            bool is_angle_held) {
    const Vec3<double> tilt = cross(axis, rotate(b.frame, {0, 0, 1}));
    if (!is_angle_held) return tilt;
    const Quat<double> q = conjugate(a.frame) * b.frame;
    return tilt + (2 * std::atan2(q.w < 0 ? -q.z : q.z, std::abs(q.w))) * axis;
  }

  /// Speed that takes an error away in the step, or the largest that is allowed [m/s].
  /// @param length  of the error's unit [m]
  SCREE_HD Vec3<double> recovery(const Vec3<double>& error, double length) const {
    const Vec3<double> speed = (length / time_step) * error;
    const double size = norm(speed);
    return size > recovery_speed ? (recovery_speed / size) * speed : speed;
  }

  /// Adds J M^-1 J^T of one body.
  static SCREE_HD void add_block(const JointRow<Real>& r, const Side& s,
                                 double (&block)[kJointTriangle]) {
    if (!s.is_free) return;
    Vec3<double> linear[kJointRows], angular[kJointRows];
    for (int k = 0; k < 3; ++k) {
      linear[k] = Vec3<double>(r.axes[k]);
      angular[k] = cross(s.arm, linear[k]);
      angular[3 + k] = static_cast<double>(r.length) * linear[k];
    }
    for (int i = 0; i < kJointRows; ++i) {
      const Vec3<double> moved = hadamard(s.inv_mass, linear[i]);
      const Vec3<double> spun = s.inv_inertia * angular[i];
      for (int j = 0; j <= i; ++j)
        block[triangle_place(i, j)] += dot(moved, linear[j]) + dot(spun, angular[j]);
    }
  }

  static SCREE_HD Real largest_number() {
    return sizeof(Real) == 8 ? static_cast<Real>(1e300) : static_cast<Real>(1e38);
  }
};

/// Impulses of joints from those of the problem.
template <class Real>
struct KeepJointImpulses {
  static constexpr const char* name = "keep_joint_impulses";
  JointPlaces places;
  Span<const Index> order;
  Span<const JointRow<Real>> row;
  Span<const Vec3<Real>> gamma;
  Span<JointImpulse<Real>> impulse;  ///< of each joint, out

  SCREE_HD void operator()(Index k) const {
    const Index j = order[k];
    const Vec3<Real> force = gamma[2 * static_cast<Offset>(k)];
    const Vec3<Real> moment = gamma[2 * static_cast<Offset>(k) + 1];
    const JointValues<Real> g =
        row[k].impulse({{force.x, force.y, force.z, moment.x, moment.y, moment.z}});
    const Real sign = places.is_turned(j) ? Real(-1) : Real(1);
    impulse[j] = {sign * row[k].world_force(g), (sign * row[k].length) * row[k].world_moment(g)};
  }
};

}  // namespace scree
