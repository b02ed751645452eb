#pragma once
// Two cones, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct ConeCone : ConvexPair<shapes::Cone, shapes::Cone> {};

}  // namespace scree
