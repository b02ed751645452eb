#pragma once
// Where affine bodies would go without forces but loads, and the velocity that they then have, by three rules for a step.
// docs/theory.md, "Affine bodies".

#include "kernels/affine/affine_state.h"
#include "kernels/math/quat.h"

namespace scree::affine {

enum class StepRule : std::uint8_t {
  implicit_euler,
  bdf2,        ///< of second order; its first step is one of implicit Euler
  rotational,  ///< implicit Euler from a target that turns: free bodies keep their spin
};

/// Moments of inertia about the center of mass in world axes, of the body as a rigid one [kg m^2].
SCREE_HD inline Sym3<double> world_inertia(const AffineMass& mass, const AffineVec& q) {
  const Sym3<double>& s = mass.second;
  const double rows[3][3] = {{s.xx, s.xy, s.xz}, {s.xy, s.yy, s.yz}, {s.xz, s.yz, s.zz}};
  Sym3<double> w;  // A S A^T
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      const Vec3d &a = q.node[k + 1], &b = q.node[l + 1];
      const double f = rows[k][l];
      w.xx += f * a.x * b.x, w.yy += f * a.y * b.y, w.zz += f * a.z * b.z;
      w.xy += f * a.x * b.y, w.xz += f * a.x * b.z, w.yz += f * a.y * b.z;
    }
  }
  return AffineMass{mass.mass, w}.inertia();
}

/// Momentum of the turn about the center of mass [kg m^2/s], world axes.
SCREE_HD inline Vec3d angular_momentum(const AffineMass& mass, const AffineVec& q,
                                       const AffineVec& v) {
  const AffineVec momentum = mass.product(v);
  Vec3d sum;
  for (int k = 1; k < 4; ++k) sum += cross(q.node[k], momentum.node[k]);
  return sum;
}

/// Angular velocity of the body with that momentum, as a rigid one.
SCREE_HD inline Vec3d turn_rate(const AffineMass& mass, const AffineVec& q, const Vec3d& momentum) {
  return inverse_on_axes(world_inertia(mass, q), 7u) * momentum;
}

/// The columns of A turned by |w| about w.
SCREE_HD inline AffineVec turned(const AffineVec& q, const Vec3d& w) {
  AffineVec r = q;
  const Quat<double> turn = exp_map(w);
  for (int k = 1; k < 4; ++k) r.node[k] = rotate(turn, q.node[k]);
  return r;
}

/// Rule of a step. @param is_second  bdf2 with a step before it
struct StepScheme {
  StepRule rule = StepRule::bdf2;
  bool is_second = false;
  double h = 0.01;   ///< [s]
  Vec3d gravity;     ///< [m/s^2]
  double ratio = 1;  ///< of h to the step before

  /// Share of a step that its end's velocity acts for: 2/3 of equal ones with bdf2.
  /// Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section III.5, also for `before`.
  SCREE_HD double share() const { return is_second ? (1 + ratio) / (1 + 2 * ratio) : 1; }
  /// What bdf2 would go on from without rates: 4/3 of now less 1/3 of the step before, of equal ones.
  SCREE_HD AffineVec before(const AffineVec& now, const AffineVec& earlier) const {
    return (share() * (1 + ratio)) * now - (share() * ratio * ratio / (1 + ratio)) * earlier;
  }

  /// What forces and energies are multiplied by beside the inertia: h^2, or 4/9 h^2.
  SCREE_HD double scale() const { return share() * share() * h * h; }
};

/// States of a body that a step begins with.
struct StepStart {
  AffineVec q, v;                  ///< now
  AffineVec earlier_q, earlier_v;  ///< one step before, with bdf2
};

struct InertialTarget {
  AffineVec q;
  AffineVec rate;  ///< its velocity, with the rotational rule
};

/// What gravity and constant loads make of a body at rest [m/s^2].
SCREE_HD inline AffineVec free_gain(const AffineMass& mass, const AffineVec& q,
                                    const Vec3d& gravity, const Vec3d& force, const Vec3d& torque) {
  AffineVec load;
  load.node[0] = force;
  load += torque_force(q, torque);
  AffineVec gain = mass.solve(load);
  gain.node[0] += gravity;
  return gain;
}

/// @param force, torque  on the body [N], [N m]; world axes
SCREE_HD inline InertialTarget inertial_target(const StepScheme& scheme, const AffineMass& mass,
                                               const StepStart& s, const Vec3d& force,
                                               const Vec3d& torque) {
  const double h = scheme.h;
  const bool turning = scheme.rule == StepRule::rotational;
  const AffineVec gain = free_gain(mass, s.q, scheme.gravity, force, turning ? Vec3d{} : torque);
  InertialTarget t;
  t.rate = s.v;
  t.q = scheme.is_second ? scheme.before(s.q, s.earlier_q) +
                               (scheme.share() * h) * scheme.before(s.v, s.earlier_v)
                         : s.q + h * s.v;
  if (turning) {
    const Vec3d momentum = angular_momentum(mass, s.q, s.v) + h * torque;
    const Vec3d w = turn_rate(mass, s.q, momentum);
    const Vec3d middle = turn_rate(mass, turned(s.q, (0.5 * h) * w), momentum);
    const AffineVec frame = turned(s.q, h * middle);
    const Vec3d end = turn_rate(mass, frame, momentum);
    for (int k = 1; k < 4; ++k) {
      t.q.node[k] = frame.node[k];
      t.rate.node[k] = cross(end, frame.node[k]);
    }
  }
  t.q += scheme.scale() * gain;
  return t;
}

/// Velocity of a body that the step took to q.
SCREE_HD inline AffineVec velocity_after(const StepScheme& scheme, const StepStart& s,
                                         const InertialTarget& t, const AffineVec& q) {
  if (scheme.is_second)
    return (1 / (scheme.share() * scheme.h)) * (q - scheme.before(s.q, s.earlier_q));
  AffineVec v = (1 / scheme.h) * (q - s.q);
  if (scheme.rule == StepRule::rotational)
    for (int k = 1; k < 4; ++k)
      v.node[k] = t.rate.node[k] + (1 / scheme.h) * (q.node[k] - t.q.node[k]);
  return v;
}

/// A bound of how far corners of a body go with a step, nearly [m]. @param radius  distance of the farthest corner
SCREE_HD inline double corner_way(const AffineVec& step, double radius) {
  double turn = 0;
  for (int k = 1; k < 4; ++k) turn += norm2(step.node[k]);
  return norm(step.node[0]) + radius * std::sqrt(turn);
}

}  // namespace scree::affine
