#pragma once
// A cylinder and an ellipsoid, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CylinderEllipsoid : ConvexPair<shapes::Cylinder, shapes::Ellipsoid> {};

}  // namespace scree
