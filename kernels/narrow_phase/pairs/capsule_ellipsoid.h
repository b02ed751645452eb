#pragma once
// A capsule and an ellipsoid, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CapsuleEllipsoid : ConvexPair<shapes::Capsule, shapes::Ellipsoid> {};

}  // namespace scree
