#pragma once
// A box and a cylinder, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct BoxCylinder : ConvexPair<shapes::Box, shapes::Cylinder> {};

}  // namespace scree
