#pragma once
// Prescribed motion of kinematic bodies.

#include <string>

#include "host/scene.h"

namespace scree {

struct Pose {
  Vec3d position;     ///< [m]
  Quatd orientation;  ///< body to world
};

/// Pose of a body at time t [s]; the initial pose when it has no motion.
Pose pose_at(const BodyDescription& body, double t);

/// Velocities that carry pose `from` to pose `to` in time h, exactly under x' = x + h
/// v, q' = exp(h w) q.
struct Rates {
  Vec3d velocity;          ///< [m/s]
  Vec3d angular_velocity;  ///< world frame [rad/s]
};
Rates rates_between(const Pose& from, const Pose& to, double h);

/// Where a motion turns a body most within a time, along its way.
struct MostTurn {
  double turn = 0;           ///< [rad]
  std::string field, value;  ///< what gives it, and that as messages show it
};
MostTurn most_turn(const Motion& motion, double time);

/// Whether the body ever turns: decides between contact layouts.
bool rotates(const BodyDescription& body);
bool turns(const Motion& motion);
/// Whether a direction keeps its place on the body: it turns about that, or not at all. @param direction  unit
bool keeps_direction(const BodyDescription& body, const Vec3d& direction);

}  // namespace scree
