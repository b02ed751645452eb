#pragma once
// A convex body and a mesh wall: each triangle near the body is a core, see ConvexOnMesh.

#include "kernels/narrow_phase/pairs/convex_manifold.h"
#include "shapes/mesh.h"

namespace scree {

template <class ShapeA>
struct MeshPair {
  using A = ShapeA;
  using B = shapes::Mesh;
  static constexpr int kTriangleBits = ConvexFeature::kBits;
};

}  // namespace scree
