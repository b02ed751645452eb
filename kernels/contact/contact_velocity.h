#pragma once
// How fast two bodies move against each other where they touch.

#include "kernels/bodies/body_view.h"
#include "kernels/contact/contact_view.h"

namespace scree {

/// Velocity of body B against body A at contact c [m/s].
template <class Real>
SCREE_HD Vec3<Real> contact_velocity(const BodyView<Real>& bodies,
                                     const ContactView<Real>& contacts, Index c) {
  const Index a = contacts.body_a[c], b = contacts.body_b[c];
  const Vec3<Real> u = bodies.velocity[b] - bodies.velocity[a];
  if (contacts.is_radial(c)) {  // arms r_a n and -r_b n, and walls do not rotate
    return u - cross(bodies.radius[a] * bodies.angular_velocity[a] +
                         bodies.radius[b] * bodies.angular_velocity[b],
                     contacts.normal[c]);
  }
  return u + cross(bodies.angular_velocity[b], contacts.lever_b(c)) -
         cross(bodies.angular_velocity[a], contacts.lever_a(c));
}

/// Its part across a normal.
template <class Real>
SCREE_HD Vec3<Real> across(const Vec3<Real>& u, const Vec3<Real>& normal) {
  return u - dot(u, normal) * normal;
}

}  // namespace scree
