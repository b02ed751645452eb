#pragma once
// A cone and a hull, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct ConeHull : ConvexPair<shapes::Cone, shapes::Hull> {};

}  // namespace scree
