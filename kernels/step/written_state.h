#pragma once
// Takes over states that a program wrote into the arrays of bodies.

#include "kernels/backend/backend.h"
#include "kernels/step/integrate.h"

namespace scree {

/// The lowest storage index that something was found wrong with.
struct FirstBad {
  Index body = -1;
  SCREE_HD void combine(const FirstBad& o) {
    if (o.body >= 0 && (body < 0 || o.body < body)) body = o.body;
  }
};

/// Checks the state of a free body; brings positions back into the periodic box and orientations to
/// unit length, as the integration pass leaves them.
template <class Real>
struct TakeWrittenState {
  static constexpr const char* name = "take_written_state";
  BodyView<Real> bodies;
  double time_step;  ///< h [s]
  PeriodicBox box;
  bool poses;  ///< whether poses may have been written; else they keep their bits

  SCREE_HD FirstBad operator()(Index i) const {
    const Quat<double> q(bodies.orientation[i]);
    const double length2 = q.w * q.w + norm2(q.vec());
    const bool is_good =
        is_in_range(bodies.position[i]) && length2 > 1e-12 && length2 < 1e12 &&
        is_speed_in_range(norm(Vec3<double>(bodies.velocity[i])), time_step) &&
        is_speed_in_range(norm(Vec3<double>(bodies.angular_velocity[i])), time_step);
    if (!is_good) return {i};
    if (!poses) return {};
    for (int axis = 0; axis < 3; ++axis) {
      double& x = bodies.position[i][axis];
      x = wrap_coordinate(x, box.lower[axis], box.length[axis]);
    }
    bodies.orientation[i] = normalized(bodies.orientation[i]);
    return {};
  }
};

/// Gives one owned body a velocity along its free axes.
template <class Real>
struct WriteVelocity {
  static constexpr const char* name = "write_velocity";
  BodyView<Real> bodies;
  Index id;
  Vec3<Real> velocity;          ///< [m/s]
  Vec3<Real> angular_velocity;  ///< world frame [rad/s]

  SCREE_HD void operator()(Index i) const {
    if (bodies.id[i] != id) return;
    const unsigned locks = bodies.locks[i];
    bodies.velocity[i] = on_axes(velocity, free_linear_axes(locks));
    bodies.angular_velocity[i] = on_axes(angular_velocity, free_angular_axes(locks));
  }
};

}  // namespace scree
