#pragma once
// Impacts in a step of bdf2, which would go on over them as from before: what was hit starts anew. docs/theory.md, "Affine bodies".

#include "kernels/affine/inertial_target.h"

namespace scree::affine {

/// Root mean square of the speeds that points of a body have about its center as it turns [m/s].
SCREE_HD inline double spin_speed(const AffineMass& mass, const AffineVec& q, const AffineVec& v) {
  const Vec3d momentum = angular_momentum(mass, q, v);
  return std::sqrt(dot(turn_rate(mass, q, momentum), momentum) / mass.mass);
}

/// Whether the mean velocity of a step is not what the velocities before it led to: that of the center, or the turn about it.
/// Along a smooth way that turns by `phi` a step it differs by 5/12 phi^2 of the speed, or 5/12 phi of what a step changed it by; a
/// spin by the first of its own speed. The speed of the center is no measure: bodies that fly together meet as bodies at rest do.
/// Nor is stretch: a body that is pushed is squeezed and swings.
/// @param s      states before the step, which was one of second order
/// @param least  speed that counts as none [m/s]
/// @param jerk   part of the speed of the center by which it may differ, too: where led bodies go parts of their way, what they push
///               becomes faster by jerks
SCREE_HD inline bool is_hit(const StepScheme& scheme, const AffineMass& mass, const StepStart& s,
                            const AffineVec& q, double least, double jerk = 0) {
  constexpr double kSmooth = 0.25, kSpin = 0.1;
  const AffineVec gained = scheme.ratio * (s.v - s.earlier_v);
  const AffineVec off = (1 / scheme.h) * (q - s.q) - (s.v + 0.5 * gained);
  const double few = scheme.h * norm(scheme.gravity) + least;
  if (norm(off.node[0]) > few + kSmooth * norm(gained.node[0]) + jerk * norm(s.v.node[0]))
    return true;
  const double turn = scheme.h * norm(turn_rate(mass, s.q, angular_momentum(mass, s.q, s.v)));
  return spin_speed(mass, s.q, off) > few + (kSpin + turn * turn) * spin_speed(mass, s.q, s.v) +
                                          kSmooth * spin_speed(mass, s.q, gained);
}

/// Velocities before and after a step.
struct StepVelocities {
  AffineVec before, after;
};

/// Those of free flight from one place to another: bodies that go on from there keep the momentum of the step, and nothing of
/// what was before it. @param gain  free_gain() @param is_elastic  a part of a body does not turn as a body does
SCREE_HD inline StepVelocities free_flight(const StepScheme& scheme, const AffineMass& mass,
                                           const AffineVec& from, const AffineVec& to,
                                           AffineVec gain, bool is_elastic) {
  const AffineVec mean = (1 / scheme.h) * (to - from);
  if (!is_elastic) {
    const Vec3d turn = turn_rate(mass, to, angular_momentum(mass, to, mean));
    for (int k = 1; k < 4; ++k) gain.node[k] += cross(turn, cross(turn, to.node[k]));
  }
  const AffineVec half = (0.5 * scheme.h) * gain;
  return {mean - half, mean + half};
}

/// What bdf2 would still add to the velocity of a center of mass that goes on in free flight: without loads v_n+1 tends to
/// (3 v_n+1 - v_n) / 2. The sum of mass times that stays, whatever bodies do to each other.
/// @param bdf2  velocities of the centers before and after the step. @param flown  those of free_flight(). @param gain  free_gain()
SCREE_HD inline Vec3d owed_velocity(const StepScheme& scheme, const StepVelocities& bdf2,
                                    const StepVelocities& flown, const AffineVec& gain) {
  const Vec3d settled = 0.5 * (3.0 * bdf2.after.node[0] - bdf2.before.node[0]);
  return settled - 0.5 * scheme.h * gain.node[0] - flown.after.node[0];
}

}  // namespace scree::affine
