#pragma once
// A capsule and a cylinder, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CapsuleCylinder : ConvexPair<shapes::Capsule, shapes::Cylinder> {};

}  // namespace scree
