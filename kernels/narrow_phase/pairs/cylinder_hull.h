#pragma once
// A cylinder and a hull, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CylinderHull : ConvexPair<shapes::Cylinder, shapes::Hull> {};

}  // namespace scree
