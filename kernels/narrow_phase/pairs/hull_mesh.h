#pragma once
// A hull and a mesh wall.

#include "kernels/narrow_phase/pairs/mesh_pair.h"

namespace scree {

struct HullMesh : MeshPair<shapes::Hull> {};

}  // namespace scree
