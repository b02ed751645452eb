#pragma once
// The first and the last pass of a step over all bodies that are convex and turn.

#include "kernels/variational/fly.h"
#include "kernels/variational/rigid_stage.h"

namespace scree {

/// What a body may turn by in a step, so that the parts of free_turn() make all of it [rad].
inline constexpr double kMostTurn = 0.5 * kMostParts * kMostOfPart;

/// The state of bodies after a step, while it is made.
struct RigidStates {
  Span<Vec3d> x;  ///< [m]
  Span<Vec3d> v;  ///< [m/s]
  Span<Quatd> q;
  Span<Vec3d> spin;  ///< angular momentum, in the frame of the body [kg m^2/s]

  SCREE_HD void take(Index i, const RigidPath& way, double h) const {
    const BodyPose end = way.pose(h);
    x[i] = end.position;
    v[i] = way.velocity_at(h);
    q[i] = end.orientation;
    // Turning it rounds its length, always to the same side if a quaternion is too long.
    const Vec3d there = rotate_back(end.orientation, rotate(way.node.orientation, way.momentum));
    const double length = norm(there);
    spin[i] = length > 0 ? (norm(way.momentum) / length) * there : there;
  }
};

/// The way of each body in a step as if it met nothing. Element: owned body. Bytes: 136 read, 184 written.
struct SetOut {
  static constexpr const char* name = "set_out";
  BodyView<double> bodies;
  Vec3d gravity;
  double h;
  Span<RigidPath> way;  ///< out

  SCREE_HD void operator()(Index i) const {
    RigidPath p;
    p.node = {bodies.position[i], bodies.orientation[i]};
    p.velocity = bodies.velocity[i];
    p.acceleration = gravity;
    p.moments = bodies.moments(i);
    p.momentum = hadamard(p.moments, rotate_back(p.node.orientation, bodies.angular_velocity[i]));
    p.bound_rotation(h);
    way[i] = p;
  }
};

/// Moves each body by a step as if it met nothing, and notes what it meets first.
struct FlyRigid {
  static constexpr const char* name = "fly_rigid";
  RigidStage stage;
  RigidStates after;      ///< out: [owned]
  Span<Index> partner;    ///< [owned] out
  Span<Index> is_active;  ///< [owned] out
  Span<Index> place;      ///< [owned] out: none

  SCREE_HD FlightSums operator()(Index i) const {
    const RigidPath a = stage.ways[i];
    FlightSums sums;
    const auto node_of = [&](Index k, Index&) { return stage.way_of(k); };
    const Event first = stage.next(i, a, 0, node_of, sums.min_gap);
    sums.deepest = i;
    after.take(i, a, stage.h);
    partner[i] = first.partner;
    sums.active = is_active[i] = first.partner == kNobody ? 0 : 1;
    place[i] = -1;
    if (first.partner == kNobody && !stage.is_covered(i, after.x[i])) sums.left = 1;
    return sums;
  }
};

/// Takes the state after a step over, brings bodies back into the periodic box and sums up.
struct TakeRigid {
  static constexpr const char* name = "take_rigid";
  RigidStates after;
  BodyView<double> bodies;
  PeriodicBox box;
  Vec3d gravity;
  double h;

  SCREE_HD MotionSums operator()(Index i) const {
    const TakeMotion centers{after.x, after.v, bodies, box, gravity, h};
    MotionSums sums = centers(i);
    if (sums.bad_body >= 0) return sums;
    const Quatd q = after.q[i];
    const Vec3d moments = bodies.moments(i), spin = after.spin[i];
    // The momentum is what a run keeps, but the rate is stored: without refinement roundings would add up.
    Vec3d w = rotate(q, rate_of(moments, spin));
    const Vec3d missing = spin - hadamard(moments, rotate_back(q, w));
    w += rotate(q, rate_of(moments, missing));
    bodies.orientation[i] = q;
    bodies.angular_velocity[i] = w;
    sums.kinetic += spin_energy(moments, spin);
    sums.angular += rotate(q, spin);
    if (!(h * norm(w) < kMostTurn)) sums.bad_body = i;
    return sums;
  }
};

}  // namespace scree
