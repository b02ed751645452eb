#pragma once
// What every pair function returns: the geometry of one contact, in double.

#include "kernels/math/quat.h"
#include "kernels/math/vec3.h"

namespace scree {

using Vec3d = Vec3<double>;
using Quatd = Quat<double>;

/// One contact between shapes A and B, world axes.
struct ContactGeometry {
  Vec3d normal;    ///< unit, from A to B
  double gap = 0;  ///< signed distance of the two surfaces [m], negative is overlap
  Vec3d arm_a;     ///< center of A to the contact point on A's surface [m]
  Vec3d arm_b;     ///< center of B to the contact point on B's surface [m]
};

/// The same contact with the roles of A and B exchanged.
SCREE_HD inline ContactGeometry swapped(const ContactGeometry& g) {
  return {-g.normal, g.gap, g.arm_b, g.arm_a};
}

/// Rigid motion of a body: velocity of its center and angular velocity, world axes.
struct RigidMotion {
  Vec3d linear;   ///< [m/s]
  Vec3d angular;  ///< [rad/s]
};

/// Normal component of the relative velocity of the contact points [m/s]; negative: they approach.
SCREE_HD inline double separation_speed(const ContactGeometry& g, const RigidMotion& a,
                                        const RigidMotion& b) {
  const Vec3d u = b.linear + cross(b.angular, g.arm_b) - a.linear - cross(a.angular, g.arm_a);
  return dot(g.normal, u);
}

/// Least envelope by which a contact is listed: its gap, or that at the end of the step [m].
/// @param u_n  separation speed [m/s]
/// @param h    time step [s]
SCREE_HD inline double needed_envelope(double gap, double u_n, double h) {
  return u_n < 0 ? gap + h * u_n : gap;
}

/// Whether a contact is listed: it is within the envelope, or will be at the end of the step.
SCREE_HD inline bool is_listed(double gap, double u_n, double envelope, double h) {
  return needed_envelope(gap, u_n, h) <= envelope;
}

}  // namespace scree
