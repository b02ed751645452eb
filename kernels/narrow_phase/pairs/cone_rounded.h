#pragma once
// A cone and a rounded shape, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct ConeRounded : ConvexPair<shapes::Cone, shapes::Rounded> {};

}  // namespace scree
