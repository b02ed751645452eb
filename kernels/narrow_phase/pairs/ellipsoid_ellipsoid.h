#pragma once
// Two ellipsoids, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct EllipsoidEllipsoid : ConvexPair<shapes::Ellipsoid, shapes::Ellipsoid> {};

}  // namespace scree
