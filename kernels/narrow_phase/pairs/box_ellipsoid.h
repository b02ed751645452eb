#pragma once
// A box and an ellipsoid, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct BoxEllipsoid : ConvexPair<shapes::Box, shapes::Ellipsoid> {};

}  // namespace scree
