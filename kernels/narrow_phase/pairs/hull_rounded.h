#pragma once
// A hull and a rounded shape, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct HullRounded : ConvexPair<shapes::Hull, shapes::Rounded> {};

}  // namespace scree
