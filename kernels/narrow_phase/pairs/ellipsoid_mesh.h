#pragma once
// An ellipsoid and a mesh wall.

#include "kernels/narrow_phase/pairs/mesh_pair.h"

namespace scree {

struct EllipsoidMesh : MeshPair<shapes::Ellipsoid> {};

}  // namespace scree
