#pragma once
// The way of a free body between two nodes of a variational integrator: its center on a parabola, its orientation that of
// a free rotation, for every part of the step. Walls stay where they are.

#include "kernels/variational/free_rotation.h"

namespace scree {

/// Where a body is.
struct BodyPose {
  Vec3d position;
  Quatd orientation;
};

/// A free body at a node, and the way that it takes from there.
struct RigidPath {
  double start = 0;  ///< time of the node [s]
  BodyPose node;
  Vec3d velocity;      ///< at the node [m/s]
  Vec3d acceleration;  ///< [m/s^2]
  Vec3d moments;       ///< principal [kg m^2]; zero: it does not turn
  Vec3d momentum;      ///< angular, in the frame of the body at the node [kg m^2/s]
  /// Bounds of its rotation, see bound_rotation().
  double most_rate = 0;    ///< [rad/s]
  double most_change = 0;  ///< [rad/s^2]

  /// One that stays.
  SCREE_HD static RigidPath fixed(const Vec3d& position, const Quatd& orientation) {
    RigidPath p;
    p.node = {position, orientation};
    return p;
  }

  SCREE_HD bool turns() const { return moments.x > 0 && norm2(momentum) > 0; }

  SCREE_HD Vec3d position(double time) const {
    const double part = time - start;
    return node.position + part * velocity + (0.5 * part * part) * acceleration;
  }
  SCREE_HD Vec3d velocity_at(double time) const { return velocity + (time - start) * acceleration; }
  SCREE_HD BodyPose pose(double time) const {
    BodyPose p{position(time), node.orientation};
    if (turns() && time != start)
      p.orientation = normalized(node.orientation * free_turn(moments, momentum, time - start));
    return p;
  }
  /// Angular velocity, world axes [rad/s].
  SCREE_HD Vec3d rate(double time) const {
    if (!turns()) return {};
    const Quatd q = pose(time).orientation;
    const Vec3d spin = rotate(node.orientation, momentum);
    return rotate(q, rate_of(moments, rotate_back(q, spin)));
  }

  /// Fills in the bounds of the rotation up to a time. A component of the rate in the frame of the body is at most what all of
  /// the energy or of the momentum makes of it, and at most what it is plus what the others can change by then. By
  /// Euler's equations that is (J_j - J_k) / J_i of their product.
  SCREE_HD void bound_rotation(double end) {
    most_rate = most_change = 0;
    if (!turns()) return;
    const Vec3d first = rate_of(moments, momentum);
    if (is_isotropic(moments)) {
      most_rate = norm(first);
      return;
    }
    const double energy = spin_energy(moments, momentum), spin = norm(momentum);
    const double length = end > start ? end - start : start - end;
    Vec3d most, change;
    for (int k = 0; k < 3; ++k) {
      const double by_energy = std::sqrt(2 * energy / moments[k]), by_spin = spin / moments[k];
      most[k] = by_energy < by_spin ? by_energy : by_spin;
    }
    for (int turn = 0; turn < 3; ++turn) {
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        change[i] = std::abs(moments[j] - moments[k]) / moments[i] * most[j] * most[k];
        const double until = std::abs(first[i]) + length * change[i];
        most[i] = until < most[i] ? until : most[i];
      }
    }
    most_rate = norm(most);
    most_change = norm(change);
  }

  /// Bound of the acceleration of a point, for its distance from the center [1/s^2].
  SCREE_HD double change_of_turn() const { return most_change + most_rate * most_rate; }
};

}  // namespace scree
