#pragma once
// A box and a hull, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct BoxHull : ConvexPair<shapes::Box, shapes::Hull> {};

}  // namespace scree
