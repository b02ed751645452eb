#pragma once
// Locked axes of bodies: Lock bits x y z rx ry rz, world axes.

#include "kernels/math/vec3.h"

namespace scree {

/// Free axes of a body, three bits: world axes that are not locked.
SCREE_HD inline unsigned free_linear_axes(unsigned locks) { return ~locks & 7u; }
SCREE_HD inline unsigned free_angular_axes(unsigned locks) { return ~(locks >> 3) & 7u; }

/// v with the components of locked axes set to zero.
template <class Real>
SCREE_HD Vec3<Real> on_axes(const Vec3<Real>& v, unsigned free) {
  return {free & 1u ? v.x : Real(0), free & 2u ? v.y : Real(0), free & 4u ? v.z : Real(0)};
}

}  // namespace scree
