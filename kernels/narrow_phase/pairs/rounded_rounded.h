#pragma once
// Two rounded shapes, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct RoundedRounded : ConvexPair<shapes::Rounded, shapes::Rounded> {};

}  // namespace scree
