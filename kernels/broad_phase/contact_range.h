#pragma once
// How far contacts are searched for, and with which velocities.

#include "kernels/bodies/body_view.h"
#include "kernels/bodies/locks.h"
#include "kernels/bodies/range.h"

namespace scree {

/// On ways up to this part of the sum of the radii, misses are deflected by less than counts.
inline constexpr double kMinTurningWay = 0.02;

/// How far contacts are searched for.
struct ContactRange {
  double envelope = 0;  ///< contacts are listed up to this gap [m]
  double h = 0;         ///< time step [s]; approaching surfaces are listed when they meet within it
  Vec3<double> period;  ///< [m]; zero: not periodic
  Span<const float> margin;   ///< how far a free body may leave its course [m]; empty: not at all
  Vec3<double> gravity_step;  ///< what loads add to the velocity of a free body, h g [m/s]
  /// Half of what two bodies may come nearer because one falls and the other is held up [m]; zero
  /// where half the envelope covers that.
  double fall = 0;
  double margin_limit = 0;  ///< largest margin, as a fraction of the diameter [-]
  /// Bodies below this storage index are free along all axes: loads give all of them gravity_step.
  Index first_held = 0;

  SCREE_HD double margin_of(Index i) const {
    return i < margin.size ? static_cast<double>(margin[i]) : 0;
  }
  /// The margin of a body of this radius on account of `fall` [m].
  SCREE_HD double fall_of(double radius) const {
    const double most = 2 * margin_limit * radius;
    return fall < most ? fall : most;
  }
};

/// Velocity of a body, or of a part of one, in the step before contacts act, v* = v + h M^-1 f with
/// respect to locked axes, less that which loads give to free bodies [m/s]. Only relative velocities
/// make contacts, and so most bodies keep the bits of their velocities. Bodies have no velocity along
/// locked axes, but parts of bodies that turn have.
template <class Real>
SCREE_HD Vec3<double> course_velocity(const BodyView<Real>& bodies, const ContactRange& range,
                                      Index i) {
  const Vec3<double> v(bodies.velocity[i]);
  if (i < range.first_held) return v;
  if (bodies.is_fixed(i)) return v - range.gravity_step;
  const unsigned free = free_linear_axes(bodies.locks[i]);
  if (free == 7u) return v;
  return v + on_axes(range.gravity_step, free) - range.gravity_step;
}

/// Radius of a body about its center that covers all it may touch within the step,
/// walls that do not move included. Zero for bodies that are not binned. Turning counts for
/// shapes that are not spheres.
template <class Real>
SCREE_HD float inflated_radius(const BodyView<Real>& bodies, const ContactRange& range, Index i) {
  const bool is_sphere = bodies.shape[i] < 0;
  if (bodies.is_fixed(i) && !is_sphere) return 0;
  double speed = norm(course_velocity(bodies, range, i) + range.gravity_step);
  if (!is_sphere) {
    speed += static_cast<double>(bodies.radius[i]) * norm(Vec3<double>(bodies.angular_velocity[i]));
  }
  const double inflated = static_cast<double>(bodies.radius[i]) + 0.5 * range.envelope +
                          range.h * speed + range.margin_of(i) + range.fall_of(bodies.radius[i]);
  // A state that is out of range has no contacts; the integration pass names it.
  if (!(inflated > 0 && inflated < kMostReach) || !is_in_range(bodies.position[i])) return 0;
  return static_cast<float>(inflated) * (1.0f + 2.4e-7f);
}

}  // namespace scree
