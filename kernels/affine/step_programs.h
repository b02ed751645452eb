#pragma once
// Passes of a step of affine bodies around its minimization: targets, velocities, poses, sums.

#include "kernels/affine/impact.h"
#include "kernels/affine/potential.h"
#include "kernels/bodies/body_view.h"

namespace scree::affine {

/// The unit quaternion of a rotation given by its columns.
/// Source: Shepperd, J. Guidance and Control 1(3), 1978: by its largest component.
SCREE_HD inline Quat<double> quaternion_of(const Vec3d (&c)[3]) {
  const double trace = c[0].x + c[1].y + c[2].z;
  const double four[4] = {1 + trace, 1 + 2 * c[0].x - trace, 1 + 2 * c[1].y - trace,
                          1 + 2 * c[2].z - trace};
  int largest = 0;
  for (int k = 1; k < 4; ++k) largest = four[k] > four[largest] ? k : largest;
  const double root = std::sqrt(four[largest]), scale = 0.5 / root;
  Quat<double> q;
  if (largest == 0) {
    q = {0.5 * root, scale * (c[1].z - c[2].y), scale * (c[2].x - c[0].z),
         scale * (c[0].y - c[1].x)};
  } else if (largest == 1) {
    q = {scale * (c[1].z - c[2].y), 0.5 * root, scale * (c[1].x + c[0].y),
         scale * (c[2].x + c[0].z)};
  } else if (largest == 2) {
    q = {scale * (c[2].x - c[0].z), scale * (c[1].x + c[0].y), 0.5 * root,
         scale * (c[2].y + c[1].z)};
  } else {
    q = {scale * (c[0].y - c[1].x), scale * (c[2].x + c[0].z), scale * (c[2].y + c[1].z),
         0.5 * root};
  }
  return normalized(q);
}

/// What a step begins with, by body; earlier states are empty without them.
struct StepStates {
  Span<AffineVec> q, v, earlier_q, earlier_v;

  SCREE_HD StepStart start(Index b) const {
    StepStart s;
    s.q = q[b], s.v = v[b];
    if (!earlier_q.empty()) s.earlier_q = earlier_q[b], s.earlier_v = earlier_v[b];
    return s;
  }
};

/// Corners that tetrahedra share must be led to one place: turning each of these on its own would not.
SCREE_HD inline StepScheme rule_of(StepScheme scheme, const BodyConstant& body) {
  if (body.lame.is_elastic() && scheme.rule == StepRule::rotational)
    scheme.rule = StepRule::implicit_euler;
  return scheme;
}

/// Bytes a row: 1,000.
struct SetTargets {
  static constexpr const char* name = "affine_set_targets";
  StepScheme scheme;
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  StepStates states;
  Span<const AffineVec> led;     ///< targets of led bodies
  Index first_led = 0;           ///< row of the first
  Span<AffineVec> target, rate;  ///< out, by row

  SCREE_HD void operator()(Index row) const {
    const Index b = body_of_row[row];
    const BodyConstant& body = bodies[b];
    const StepStart start = states.start(b);
    InertialTarget t;
    if (body.is_led) {
      t.q = led[row - first_led];
    } else {
      t = inertial_target(rule_of(scheme, body), body.mass, start, body.force, body.torque);
    }
    target[row] = t.q, rate[row] = t.rate;
  }
};

/// Velocities after the step, and which bodies it hit; states move on.
struct FinishStep {
  static constexpr const char* name = "affine_finish_step";
  StepScheme scheme;
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  StepStates states;
  Span<const AffineVec> q;               ///< by body, after the step
  Span<const AffineVec> target, rate;    ///< by row
  Span<AffineVec> earlier_q, earlier_v;  ///< out, by body
  Span<Index> hit;                       ///< out, by row
  double least = 0;                      ///< speed that counts as none [m/s]
  double jerk = 0;                       ///< see is_hit()

  SCREE_HD void operator()(Index row) const {
    const Index b = body_of_row[row];
    StepScheme own = rule_of(scheme, bodies[b]);
    if (bodies[b].is_led) own.rule = StepRule::implicit_euler, own.is_second = false;
    const StepStart start = states.start(b);
    const bool may_be_hit = own.is_second && !bodies[b].lame.is_elastic();
    hit[row] = may_be_hit && is_hit(own, bodies[b].mass, start, q[b], least, jerk) ? 1 : 0;
    states.v[b] = velocity_after(own, start, {target[row], rate[row]}, q[b]);
    states.q[b] = q[b];
    earlier_q[b] = start.q, earlier_v[b] = start.v;
  }
};

/// Velocities of marked bodies at both ends of the step, as if they had flown freely.
struct StartAnew {
  static constexpr const char* name = "affine_start_anew";
  StepScheme scheme;
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  Span<const Index> marked;  ///< by row
  Span<const AffineVec> q;   ///< by body
  Span<AffineVec> v;
  Span<const AffineVec> earlier_q;
  Span<AffineVec> earlier_v;
  Span<Vec3d> owed;         ///< without `added`: out, by row: momentum that is left over [kg m/s]
  Span<const Vec3d> added;  ///< by row, to velocities [m/s]

  SCREE_HD void operator()(Index row) const {
    if (marked[row] == 0) return;
    const Index b = body_of_row[row];
    const BodyConstant& body = bodies[b];
    const AffineVec gain = free_gain(body.mass, q[b], scheme.gravity, body.force, body.torque);
    StepVelocities flown =
        free_flight(scheme, body.mass, earlier_q[b], q[b], gain, body.lame.is_elastic());
    if (added.empty()) {
      owed[row] = body.mass.mass * owed_velocity(scheme, {earlier_v[b], v[b]}, flown, gain);
      return;
    }
    for (AffineVec* each : {&flown.before, &flown.after}) each->node[0] += added[row];
    v[b] = flown.after, earlier_v[b] = flown.before;
  }
};

/// The rotation nearest to that of a body.
SCREE_HD inline Quat<double> orientation_of(const AffineVec& q) {
  Vec3d columns[3];
  nearest_rotation(q, columns);
  return quaternion_of(columns);
}

/// The pose of a body as a rigid one. @param velocity  of its center of mass  @param rate  of its turn about that
SCREE_HD inline void write_pose(const AffineVec& q, const Vec3d& velocity, const Vec3d& rate,
                                Index body, const BodyView<double>& store) {
  const Quat<double> turn = orientation_of(q), before = store.orientation[body];
  const double same = turn.w * before.w + turn.x * before.x + turn.y * before.y + turn.z * before.z;
  store.position[body] = q.node[0];
  store.orientation[body] = same < 0 ? Quat<double>{-turn.w, -turn.x, -turn.y, -turn.z} : turn;
  store.velocity[body] = velocity;
  store.angular_velocity[body] = rate;
}

/// Poses of the bodies as rigid ones.
struct WritePoses {
  static constexpr const char* name = "affine_write_poses";
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  Span<const AffineVec> q, v;  ///< by body
  BodyView<double> store;
  double earlier_step = 0;          ///< how long the step before took [s]; 0: there was none
  Span<const AffineVec> earlier_q;  ///< by body, where that began

  SCREE_HD void operator()(Index row) const {
    const Index b = body_of_row[row];
    if (bodies[b].lame.is_elastic()) return;  // part of a body
    const AffineMass& mass = bodies[b].mass;
    const bool is_led = bodies[b].is_led && earlier_step > 0;
    write_pose(q[b], v[b].node[0],
               is_led ? led_rate(b) : turn_rate(mass, q[b], angular_momentum(mass, q[b], v[b])), b,
               store);
  }

 private:
  /// Led bodies go straight in their coordinates, where turns are too slow by a sine.
  SCREE_HD Vec3d led_rate(Index b) const {
    return (1 / earlier_step) *
           log_map(orientation_of(q[b]) * conjugate(orientation_of(earlier_q[b])));
  }
};

/// Sums over free bodies.
struct AffineSums {
  double kinetic = 0;   ///< [J]
  double strain = 0;    ///< largest |A^T A - I| of stiff bodies
  double turn = 0;      ///< their largest angular velocity [rad/s]
  double led_turn = 0;  ///< that of led bodies [rad/s]
  Vec3d momentum;       ///< [kg m/s]
  Vec3d angular;        ///< about the origin [kg m^2/s]
  Index bad_body = -1;  ///< one whose state is no number
  Index hit = 0;        ///< bodies that were
  SCREE_HD void combine(const AffineSums& o) {
    kinetic += o.kinetic;
    strain = o.strain > strain ? o.strain : strain;
    turn = o.turn > turn ? o.turn : turn;
    led_turn = o.led_turn > led_turn ? o.led_turn : led_turn;
    momentum += o.momentum;
    angular += o.angular;
    bad_body = bad_body < 0 ? o.bad_body : bad_body;
    hit += o.hit;
  }
};
struct SumBody {
  static constexpr const char* name = "affine_sums";
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  Span<const AffineVec> q, v;  ///< by body
  Span<const Index> hit;       ///< by row
  Span<const Vec3d> rate;      ///< by body of the scene: its angular velocity [rad/s]

  SCREE_HD AffineSums operator()(Index row) const {
    const Index b = body_of_row[row];
    const BodyConstant& body = bodies[b];
    AffineSums s;
    s.strain = body.lame.is_elastic() ? 0 : strain_norm(q[b]);
    if (!(dot(q[b], q[b]) < 1e30 && dot(v[b], v[b]) < 1e30)) s.bad_body = b;
    if (body.is_led) {
      s.led_turn = norm(rate[b]);
      return s;
    }
    s.hit = hit[row];
    s.kinetic = 0.5 * dot(v[b], body.mass.product(v[b]));
    s.momentum = body.mass.mass * v[b].node[0];
    const Vec3d own = angular_momentum(body.mass, q[b], v[b]);
    s.angular = cross(q[b].node[0], s.momentum) + own;
    if (!body.lame.is_elastic()) s.turn = norm(turn_rate(body.mass, q[b], own));
    return s;
  }
};

/// Of stiff bodies.
struct StrainOfRow {
  static constexpr const char* name = "affine_strain";
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  Span<const AffineVec> q;  ///< by body

  SCREE_HD Largest<double> operator()(Index row) const {
    const Index b = body_of_row[row];
    return {bodies[b].lame.is_elastic() ? 0 : strain_norm(q[b])};
  }
};

/// Led bodies that are not where they should be.
struct MissedTargets {
  static constexpr const char* name = "affine_missed_targets";
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  Span<const AffineVec> start, q;  ///< by body
  Span<const AffineVec> target;    ///< by row
  double tolerance = 0;            ///< [m]

  SCREE_HD Sums<1> operator()(Index row) const {
    const Index b = body_of_row[row];
    Sums<1> s;
    if (!bodies[b].is_led) return s;
    const double way = corner_way(target[row] - start[b], bodies[b].radius);
    const double miss = corner_way(target[row] - q[b], bodies[b].radius);
    s.value[0] = miss > tolerance + 0.01 * way ? 1 : 0;
    return s;
  }
};

}  // namespace scree::affine
