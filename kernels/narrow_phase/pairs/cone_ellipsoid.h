#pragma once
// A cone and an ellipsoid, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct ConeEllipsoid : ConvexPair<shapes::Cone, shapes::Ellipsoid> {};

}  // namespace scree
