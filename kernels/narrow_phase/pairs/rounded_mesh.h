#pragma once
// A rounded shape and a mesh wall.

#include "kernels/narrow_phase/pairs/mesh_pair.h"

namespace scree {

struct RoundedMesh : MeshPair<shapes::Rounded> {};

}  // namespace scree
