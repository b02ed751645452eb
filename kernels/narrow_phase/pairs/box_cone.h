#pragma once
// A box and a cone, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct BoxCone : ConvexPair<shapes::Box, shapes::Cone> {};

}  // namespace scree
