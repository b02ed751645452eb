#pragma once
// A capsule and a rounded shape, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CapsuleRounded : ConvexPair<shapes::Capsule, shapes::Rounded> {};

}  // namespace scree
