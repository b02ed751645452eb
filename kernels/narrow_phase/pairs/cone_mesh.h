#pragma once
// A cone and a mesh wall.

#include "kernels/narrow_phase/pairs/mesh_pair.h"

namespace scree {

struct ConeMesh : MeshPair<shapes::Cone> {};

}  // namespace scree
