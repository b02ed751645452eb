#pragma once
// A cylinder and a rounded shape, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CylinderRounded : ConvexPair<shapes::Cylinder, shapes::Rounded> {};

}  // namespace scree
