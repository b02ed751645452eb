#pragma once
// A cylinder and a mesh wall.

#include "kernels/narrow_phase/pairs/mesh_pair.h"

namespace scree {

struct CylinderMesh : MeshPair<shapes::Cylinder> {};

}  // namespace scree
