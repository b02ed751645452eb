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

/// Velocity of the contact point of B relative to that of A [m/s].
SCREE_HD inline Vec3d contact_velocity(const ContactGeometry& g, const RigidMotion& a,
                                       const RigidMotion& b) {
  return b.linear + cross(b.angular, g.arm_b) - a.linear - cross(a.angular, g.arm_a);
}
/// Its normal component; negative: they approach.
SCREE_HD inline double separation_speed(const ContactGeometry& g, const RigidMotion& a,
                                        const RigidMotion& b) {
  return dot(g.normal, contact_velocity(g, a, b));
}

/// Least envelope by which a contact is listed: its gap, or that at the end of the step [m].
/// @param u_n  separation speed [m/s]
/// @param h    time step [s]
SCREE_HD inline double needed_envelope(double gap, double u_n, double h) {
  return u_n < 0 ? gap + h * u_n : gap;
}

/// The same where the contact law asks for a separation speed by sliding: a contact that would act is listed whatever the
/// envelope is. Else a body that lands while it slides would be seen below the height to which sliding lifts it, and be thrown up
/// there. Not for two spheres, which may pass each other that near.
/// @param u     velocity of B relative to A at the contact [m/s]
/// @param lift  separation speed per sliding speed [-]: the friction of the convex law; 0: none
SCREE_HD inline double needed_envelope(double gap, const Vec3d& normal, const Vec3d& u, double h,
                                       double lift) {
  const double u_n = dot(normal, u);
  if (lift > 0 && gap > 0) {
    const double slide2 = norm2(u) - u_n * u_n;
    const double at_end = gap + h * u_n;
    if (at_end < 0 || at_end * at_end < h * h * lift * lift * slide2)
      return at_end - h * lift * std::sqrt(slide2 > 0 ? slide2 : 0);
  }
  return needed_envelope(gap, u_n, h);
}

}  // namespace scree
