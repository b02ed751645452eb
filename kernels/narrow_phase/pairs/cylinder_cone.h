#pragma once
// A cylinder and a cone, by their cores.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CylinderCone : ConvexPair<shapes::Cylinder, shapes::Cone> {};

}  // namespace scree
