#pragma once
// Loads per body: forces and torques that a program sets beside gravity. docs/theory.md,
// section "Time step".

#include <cmath>

#include "kernels/backend/backend.h"
#include "kernels/bodies/body_view.h"
#include "kernels/bodies/locks.h"
#include "kernels/bodies/range.h"
#include "kernels/math/sym3.h"

namespace scree {

/// What the pass over loads adds up.
struct LoadSums {
  double squares = 0;   ///< sum over free bodies of |h g + h f / m|^2 [m^2/s^2]
  double largest = 0;   ///< largest |h f / m| [m/s]
  Index bad_body = -1;  ///< lowest storage index with loads that are not finite or too large
  SCREE_HD void combine(const LoadSums& o) {
    squares += o.squares;
    if (o.largest > largest) largest = o.largest;
    if (o.bad_body >= 0 && (bad_body < 0 || o.bad_body < bad_body)) bad_body = o.bad_body;
  }
};

/// What loads add to the velocity of an owned body in a step along its free axes: h f / m, h I^-1 t.
/// Bytes per body (float): 4 + 24 + 28 read, 24 written; loads by id, so not in storage order.
template <class Real>
struct LoadGains {
  static constexpr const char* name = "load_gains";
  BodyView<Real> bodies;
  Span<const Vec3<Real>> force;   ///< by id, world frame [N]
  Span<const Vec3<Real>> torque;  ///< by id, about the center of mass, world frame [N m]
  Vec3<Real> gravity_step;        ///< h g [m/s]
  Real time_step;                 ///< h [s]
  Span<Vec3<Real>> linear;        ///< [owned_count] out [m/s]
  Span<Vec3<Real>> angular;       ///< [owned_count] out [rad/s]

  SCREE_HD LoadSums operator()(Index i) const {
    const Index id = bodies.id[i];
    const unsigned axes = free_linear_axes(bodies.locks[i]);
    const Vec3<Real> v = on_axes((time_step * bodies.inv_mass[i]) * force[id], axes);
    const Vec3<Real> w = time_step * angular_acceleration(i, torque[id]);
    linear[i] = v;
    angular[i] = w;
    LoadSums s;
    s.squares = norm2(Vec3<double>(on_axes(gravity_step, axes) + v));
    s.largest = norm(Vec3<double>(v));
    const bool is_good = is_speed_in_range(s.largest, time_step) &&
                         is_speed_in_range(norm(Vec3<double>(w)), time_step);
    if (!is_good) s = {0, 0, i};
    return s;
  }

 private:
  SCREE_HD Vec3<Real> angular_acceleration(Index i, const Vec3<Real>& t) const {
    const unsigned axes = free_angular_axes(bodies.locks[i]);
    const Vec3<Real> moments = bodies.moments(i);
    if (moments.x == moments.y && moments.y == moments.z)
      return on_axes((Real(1) / moments.x) * t, axes);
    return inverse_on_axes(rotated_diagonal(bodies.orientation[i], moments), axes) * t;
  }
};

/// The velocities of all bodies with what loads add; those of ghosts come with it.
template <class Real>
struct AddLoadGains {
  static constexpr const char* name = "add_load_gains";
  BodyView<Real> bodies;
  Span<const Vec3<Real>> linear;      ///< [owned_count] [m/s]
  Span<const Vec3<Real>> angular;     ///< [owned_count] [rad/s]
  Span<Vec3<Real>> velocity;          ///< [count] out [m/s]
  Span<Vec3<Real>> angular_velocity;  ///< [count] out [rad/s]

  SCREE_HD void operator()(Index i) const {
    const bool is_owned = bodies.is_owned(i);
    velocity[i] = is_owned ? bodies.velocity[i] + linear[i] : bodies.velocity[i];
    angular_velocity[i] =
        is_owned ? bodies.angular_velocity[i] + angular[i] : bodies.angular_velocity[i];
  }
};

}  // namespace scree
