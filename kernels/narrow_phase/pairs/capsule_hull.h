#pragma once
// A capsule and a hull, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CapsuleHull : ConvexPair<shapes::Capsule, shapes::Hull> {};

}  // namespace scree
