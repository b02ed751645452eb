#pragma once
// Projections onto the Coulomb cone and its relatives. docs/theory.md, section "Cones".
//
// Lengths are those of impulses times a weight [1/kg], velocities: squares of the impulses of dust or mountains are no floats.

#include "kernels/math/scalar.h"
#include "kernels/math/vec3.h"

namespace scree {

/// Euclidean projection of x onto the Coulomb cone K = {(n, t) : |t| <= mu n}.
/// @param mu  friction coefficient [-], >= 0
/// @param x   contact-frame impulse (n, t1, t2) [N s]
/// @return    nearest point of K [N s]; zero when x lies in the polar cone
/// Source: Mazhar et al., ACM TOG 34(3), 2015; docs/theory.md eq. (6).
template <class Real>
SCREE_HD ContactVec<Real> project_cone(Real mu, const ContactVec<Real>& x) {
  const Real tangential = std::sqrt(x.t1 * x.t1 + x.t2 * x.t2);
  if (tangential <= mu * x.n) return x;
  if (mu * tangential <= -x.n) return {0, 0, 0};
  const Real n = (x.n + mu * tangential) / (Real(1) + mu * mu);
  const Real scale = tangential > Real(0) ? mu * n / tangential : Real(0);
  return {n, scale * x.t1, scale * x.t2};
}

/// Projection of the world vector y onto the Coulomb cone about the unit normal, in the metric
/// a_n (normal) and a_t (tangential); equal weights give the Euclidean projection.
/// For a contact whose 3x3 Delassus block is diag(a_n, a_t, a_t) this is the exact minimizer of its
/// one-contact problem.
/// @param y  impulse, world frame [N s]
/// Source: docs/theory.md eq. (7).
template <class Real>
SCREE_HD Vec3<Real> project_cone(Real mu, const Vec3<Real>& normal, const Vec3<Real>& y, Real a_n,
                                 Real a_t) {
  const Real y_n = dot(normal, y);
  const Vec3<Real> v_t = a_t * (y - y_n * normal);
  const Real square = norm2(v_t);
  const Real bound = mu * (a_t * y_n);
  const auto sticks = (y_n >= Real(0)) & (square <= bound * bound);
  const Real inverse_length = inverse_sqrt(square);
  const Real pull = a_n * y_n + mu * (square * inverse_length);
  const Real n = select(pull <= Real(0), Real(0), pull * inverse(a_n + mu * mu * a_t));
  const Real slide = mu * n * inverse_length;
  return {select(sticks, y.x, n * normal.x + slide * v_t.x),
          select(sticks, y.y, n * normal.y + slide * v_t.y),
          select(sticks, y.z, n * normal.z + slide * v_t.z)};
}

/// Projection of the tangential part of y onto the disk of radius mu y_n, and of y_n onto what
/// presses. Impulses that do not move when a step against their contact velocities is followed by
/// this one satisfy Coulomb's law itself: the normal part does not feel the tangential one, where
/// the projection onto the cone lifts it.
/// @param y       impulse, world frame [N s]
/// @param weight  any of the contact's metric; the result does not depend on it
/// Source: Alart & Curnier, CMAME 92, 1991; docs/theory.md eq. (7b).
template <class Real>
SCREE_HD Vec3<Real> project_disk(Real mu, const Vec3<Real>& normal, const Vec3<Real>& y,
                                 Real weight) {
  const Real y_n = dot(normal, y);
  const Vec3<Real> y_t = y - y_n * normal;
  const Real n = select(y_n <= Real(0), Real(0), y_n);
  const Real square = norm2(weight * y_t);
  const Real bound = mu * (weight * n);
  const Real scale = select(square <= bound * bound, Real(1), bound * inverse_sqrt(square));
  return {n * normal.x + scale * y_t.x, n * normal.y + scale * y_t.y, n * normal.z + scale * y_t.z};
}

/// Length of a part of an impulse [N s].
/// @param weight  any of the contact's metric
template <class Real>
SCREE_HD Real weighed_length(Real weight, const Vec3<Real>& part) {
  return norm(weight * part) / weight;
}

/// One bounded part of a contact impulse that shares the contact's normal force.
template <class Real>
struct BoundedPart {
  Real mu;      ///< bound per unit of normal impulse [-], >= 0
  Real weight;  ///< metric weight, > 0
  Real length;  ///< norm of the part before projection [N s]
};

/// Normal component of the projection onto {|t_k| <= mu_k n for every part k}.
/// The derivative of the distance is increasing, concave and piecewise linear in n,
/// so Newton's method from n = 0 walks monotonically and lands exactly after at most one step
/// per part and one more.
/// @param a_n  metric weight of the normal
/// @param y_n  normal impulse before projection [N s]
/// Source: docs/theory.md eq. (8); cones of Tasora & Anitescu, Meccanica 48, 2013.
template <int Parts, class Real>
SCREE_HD Real shared_normal(Real a_n, Real y_n, const BoundedPart<Real> (&part)[Parts]) {
  Real n = 0;
  for (int iteration = 0; iteration <= Parts; ++iteration) {
    Real pull = a_n * y_n;
    Real stiffness = a_n;
    for (int k = 0; k < Parts; ++k) {
      if (part[k].length > part[k].mu * n) {
        pull += part[k].weight * part[k].mu * part[k].length;
        stiffness += part[k].weight * part[k].mu * part[k].mu;
      }
    }
    const Real next = pull / stiffness;
    if (next <= n) break;
    n = next;
  }
  return n;
}

}  // namespace scree
