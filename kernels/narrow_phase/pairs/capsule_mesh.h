#pragma once
// A capsule and a mesh wall.

#include "kernels/narrow_phase/pairs/mesh_pair.h"

namespace scree {

struct CapsuleMesh : MeshPair<shapes::Capsule> {};

}  // namespace scree
