#pragma once
// Two hulls, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct HullHull : ConvexPair<shapes::Hull, shapes::Hull> {};

}  // namespace scree
