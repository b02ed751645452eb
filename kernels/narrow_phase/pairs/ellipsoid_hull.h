#pragma once
// An ellipsoid and a hull, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct EllipsoidHull : ConvexPair<shapes::Ellipsoid, shapes::Hull> {};

}  // namespace scree
