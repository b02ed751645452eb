#pragma once
// An ellipsoid and a rounded shape, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct EllipsoidRounded : ConvexPair<shapes::Ellipsoid, shapes::Rounded> {};

}  // namespace scree
