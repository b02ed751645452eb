#pragma once
// A box and a rounded shape, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct BoxRounded : ConvexPair<shapes::Box, shapes::Rounded> {};

}  // namespace scree
