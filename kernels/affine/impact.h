#pragma once
// Impacts in a step of bdf2, which would go on over them as from before: what was hit starts anew. docs/theory.md, "Affine bodies".

#include "kernels/affine/inertial_target.h"

namespace scree::affine {

/// Root mean square of the speeds of a body's points [m/s].
SCREE_HD inline double mean_speed(const AffineMass& mass, const AffineVec& v) {
  return std::sqrt(dot(v, mass.product(v)) / mass.mass);
}

/// Whether the mean velocity of a step is not what the velocities before it led to: that of the center, or that of points about it.
/// Along a smooth way that turns by `phi` a step it differs by 5/12 phi^2 of the speed, or 5/12 phi of what a step changed it by; a
/// spin by the first of its own speed. The speed of the center is no measure: bodies that fly together meet as bodies at rest do.
/// @param s  states before the step, which was one of second order. @param least  speed that counts as none [m/s]
SCREE_HD inline bool is_hit(const StepScheme& scheme, const AffineMass& mass, const StepStart& s,
                            const AffineVec& q, double least) {
  constexpr double kSmooth = 0.25;
  const AffineVec gained = scheme.ratio * (s.v - s.earlier_v);
  const AffineVec off = (1 / scheme.h) * (q - s.q) - (s.v + 0.5 * gained);
  const double few = scheme.h * norm(scheme.gravity) + least;
  if (norm(off.node[0]) > few + kSmooth * norm(gained.node[0])) return true;
  const auto about_center = [&](AffineVec v) {
    v.node[0] = {};
    return mean_speed(mass, v);
  };
  const double turn = scheme.h * norm(turn_rate(mass, s.q, angular_momentum(mass, s.q, s.v)));
  return about_center(off) > few + turn * turn * about_center(s.v) + kSmooth * about_center(gained);
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
