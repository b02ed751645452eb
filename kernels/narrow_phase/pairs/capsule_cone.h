#pragma once
// A capsule and a cone, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CapsuleCone : ConvexPair<shapes::Capsule, shapes::Cone> {};

}  // namespace scree
