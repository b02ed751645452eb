#pragma once
// A box and a mesh wall.

#include "kernels/narrow_phase/pairs/mesh_pair.h"

namespace scree {

struct BoxMesh : MeshPair<shapes::Box> {};

}  // namespace scree
