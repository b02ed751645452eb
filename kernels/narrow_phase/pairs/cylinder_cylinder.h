#pragma once
// Two cylinders, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CylinderCylinder : ConvexPair<shapes::Cylinder, shapes::Cylinder> {};

}  // namespace scree
