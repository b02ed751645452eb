#pragma once
// Free bodies whose surface is a triangle mesh, for scenes in code: those of the dynamics "affine". Walls name a mesh of the scene
// in Shape::mesh.

#include "host/scene.h"

namespace scree {

/// Gives a free body a mesh of its own as shape: moves the mesh to its center of mass and principal
/// axes, and the body with it. @throws std::invalid_argument for a surface without a solid inside
void set_free_mesh(Scene& scene, BodyDescription& body, TriangleMesh mesh);

}  // namespace scree
